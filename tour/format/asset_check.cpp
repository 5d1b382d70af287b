#include "tour/format/asset_check.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/base/deflate.h"
#include "core/image/jpeg_structure.h"
#include "tour/format/glb_check.h"

namespace skyquilt::tour {
namespace {

using Bytes = std::span<const uint8_t>;

constexpr std::array<uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

uint32_t BigEndian(Bytes bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8U | bytes[at + i];
  return value;
}

void RequireSize(uint64_t width, uint64_t height) {
  const std::string limit = std::to_string(kMaxPictureSide);
  if (width == 0 || height == 0) throw base::Refused("its width or height is 0");
  if (width > kMaxPictureSide || height > kMaxPictureSide) {
    throw base::Refused("it has " + std::to_string(width) + " x " + std::to_string(height) + " pixels: at most " + limit + " x " + limit +
                        " are shown");
  }
}

bool IsPngPixel(uint8_t depth, uint8_t color) {
  switch (color) {
    case 0:  // grey
      return depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16;
    case 3:  // palette
      return depth == 1 || depth == 2 || depth == 4 || depth == 8;
    case 2:  // colour
    case 4:  // grey with alpha
    case 6:  // colour with alpha
      return depth == 8 || depth == 16;
    default:
      return false;
  }
}

// header: of the chunk IHDR.
void CheckPngHeader(Bytes header) {
  if (header.size() != 13) throw base::Refused("its PNG header is damaged");
  RequireSize(BigEndian(header, 0), BigEndian(header, 4));
  const bool good = IsPngPixel(header[8], header[9]) && header[10] == 0 && header[11] == 0 && header[12] <= 1;
  if (!good) throw base::Refused("its PNG header is damaged");
}

void CheckPng(Bytes bytes) {
  if (bytes.size() < kPngSignature.size() || !std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin())) {
    throw base::Refused("it is not a PNG picture");
  }
  bool first = true, has_pixels = false;
  Bytes rest = bytes.subspan(kPngSignature.size());
  // Length, name, content, checksum.
  while (rest.size() >= 12 && BigEndian(rest, 0) <= rest.size() - 12) {
    const size_t length = BigEndian(rest, 0);
    const Bytes named = rest.subspan(4, 4 + length);
    const std::string_view name(reinterpret_cast<const char*>(named.data()), 4);
    if (base::Crc32({reinterpret_cast<const char*>(named.data()), named.size()}) != BigEndian(rest, 8 + length)) {
      throw base::Refused("it is a damaged PNG picture: a checksum is wrong");
    }
    if (first != (name == "IHDR")) throw base::Refused("it is a damaged PNG picture: its header is not at its beginning");
    if (first) CheckPngHeader(named.subspan(4));
    first = false;
    has_pixels = has_pixels || name == "IDAT";
    rest = rest.subspan(12 + length);
    if (name != "IEND") continue;
    if (!has_pixels) throw base::Refused("it is a PNG picture without pixels");
    if (!rest.empty()) throw base::Refused("it goes on after the end of the PNG picture");
    return;
  }
  throw base::Refused("it is a PNG picture that ends early");
}

void CheckJpeg(Bytes bytes) {
  const image::JpegStructure jpeg = image::ParseJpeg(bytes, false);
  if (!jpeg.is_jpeg) throw base::Refused("it is not a JPEG picture");
  if (!jpeg.complete) throw base::Refused("it is a JPEG picture that ends early");
  RequireSize(static_cast<uint64_t>(jpeg.width), static_cast<uint64_t>(jpeg.height));
  if (jpeg.frame_marker > 0xC2) throw base::Refused("it is a kind of JPEG that browsers do not show: save it as a usual JPEG");
}

}  // namespace

void CheckAsset(AssetType type, Bytes bytes) {
  if (bytes.size() > kMaxAssetBytes) throw base::Refused("it is larger than 50 MiB");
  switch (type) {
    case AssetType::kGlb:
      CheckGlb(bytes);
      break;
    case AssetType::kPng:
      CheckPng(bytes);
      break;
    case AssetType::kJpg:
      CheckJpeg(bytes);
      break;
  }
}

}  // namespace skyquilt::tour
