#include "prepare/input/picture_header.h"

#include <algorithm>
#include <array>
#include <climits>

#include "core/base/errors.h"
#include "core/base/memory_map.h"
#include "core/image/jpeg_structure.h"

namespace skyquilt::prepare::input {
namespace {

using Bytes = std::span<const uint8_t>;

constexpr std::array<uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};

// 0 beyond the end.
uint32_t NumberAt(Bytes bytes, size_t at, size_t size, bool little_endian) {
  if (at > bytes.size() || bytes.size() - at < size) return 0;
  uint32_t value = 0;
  for (size_t i = 0; i < size; ++i) value |= uint32_t{bytes[at + i]} << (8U * (little_endian ? i : size - 1 - i));
  return value;
}

int SizeOf(uint32_t value) {
  return value <= INT_MAX ? static_cast<int>(value) : 0;
}

// Number of channels and the components of a JPEG follow its size in the frame header.
int JpegChannels(Bytes bytes) {
  for (size_t at = 2; at + 9 < bytes.size();) {
    if (bytes[at] != 0xFF) return 0;
    const uint8_t marker = bytes[at + 1];
    if (marker == 0xFF) {
      ++at;
      continue;
    }
    if (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) return bytes[at + 9];
    if (marker == 0xD9 || marker == 0xDA) return 0;
    const bool has_length = marker != 0x01 && !(marker >= 0xD0 && marker <= 0xD8);
    at += has_length ? 2 + std::max<size_t>(2, NumberAt(bytes, at + 2, 2, false)) : 2;
  }
  return 0;
}

// A palette has alpha when a tRNS chunk comes before the pixels.
bool PngHasTransparency(Bytes bytes) {
  for (size_t at = kPngSignature.size(); at + 8 <= bytes.size();) {
    const size_t length = NumberAt(bytes, at, 4, false);
    const auto is = [&](const char* name) { return std::equal(name, name + 4, bytes.begin() + static_cast<std::ptrdiff_t>(at + 4)); };
    if (is("tRNS")) return true;
    if (is("IDAT") || is("IEND")) return false;
    at += 12 + length;
  }
  return false;
}

PictureHeader ParsePng(Bytes bytes) {
  PictureHeader header{.format = PictureFormat::kPng};
  if (bytes.size() < 26) return header;
  header.width = SizeOf(NumberAt(bytes, 16, 4, false));
  header.height = SizeOf(NumberAt(bytes, 20, 4, false));
  switch (bytes[25]) {
    case 0:
      header.channels = 1;
      break;
    case 2:
      header.channels = 3;
      break;
    case 3:
      header.has_alpha = PngHasTransparency(bytes);
      header.channels = header.has_alpha ? 4 : 3;
      break;
    case 4:
      header.channels = 2;
      header.has_alpha = true;
      break;
    case 6:
      header.channels = 4;
      header.has_alpha = true;
      break;
    default:
      break;
  }
  return header;
}

// TIFF 6.0, section 2 and the tags of its first directory.
PictureHeader ParseTiff(Bytes bytes) {
  constexpr uint32_t kImageWidth = 256, kImageLength = 257, kPhotometric = 262, kSamplesPerPixel = 277, kExtraSamples = 338;
  constexpr uint32_t kModelPixelScale = 33550, kModelTransformation = 34264, kGeoKeys = 34735;
  constexpr uint32_t kPalette = 3;
  PictureHeader header{.format = PictureFormat::kTiff, .channels = 1};
  const bool little = bytes[0] == 'I';
  const size_t directory = NumberAt(bytes, 4, 4, little);
  const size_t n_entries = NumberAt(bytes, directory, 2, little);
  bool has_scale = false, has_keys = false, palette = false;
  for (size_t i = 0; i < n_entries; ++i) {
    const size_t entry = directory + 2 + 12 * i;
    if (entry > bytes.size() || bytes.size() - entry < 12) break;
    const uint32_t tag = NumberAt(bytes, entry, 2, little), type = NumberAt(bytes, entry + 2, 2, little);
    // Numbers of two bytes lie at the beginning of the field, in either byte order.
    const uint32_t value = NumberAt(bytes, entry + 8, type == 3 ? 2 : 4, little);
    if (tag == kImageWidth) header.width = SizeOf(value);
    if (tag == kImageLength) header.height = SizeOf(value);
    if (tag == kPhotometric) palette = value == kPalette;
    if (tag == kSamplesPerPixel) header.channels = value <= 1000 ? static_cast<int>(value) : 0;
    // One extra channel that is called alpha, premultiplied or not; 0 is one of unknown meaning.
    if (tag == kExtraSamples) header.has_alpha = NumberAt(bytes, entry + 4, 4, little) == 1 && (value == 1 || value == 2);
    has_scale = has_scale || tag == kModelPixelScale || tag == kModelTransformation;
    has_keys = has_keys || tag == kGeoKeys;
  }
  if (palette) header.channels = 3;
  header.has_alpha = header.has_alpha && (header.channels == 2 || header.channels == 4);
  header.is_map = has_scale && has_keys;
  return header;
}

}  // namespace

PictureHeader ParsePictureHeader(Bytes bytes) {
  if (bytes.size() >= kPngSignature.size() && std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin())) return ParsePng(bytes);
  if (bytes.size() >= 8) {
    const bool little = bytes[0] == 'I' && bytes[1] == 'I', big = bytes[0] == 'M' && bytes[1] == 'M';
    if ((little || big) && NumberAt(bytes, 2, 2, little) == 42) return ParseTiff(bytes);
  }
  const image::JpegStructure jpeg = image::ParseJpeg(bytes, true);
  if (!jpeg.is_jpeg) return {};
  return {.format = PictureFormat::kJpeg, .width = jpeg.width, .height = jpeg.height, .channels = JpegChannels(bytes)};
}

PictureHeader ReadPictureHeader(const std::filesystem::path& file) {
  try {
    const base::MemoryMap map(file);
    return ParsePictureHeader(map.bytes());
  } catch (const base::InputError&) {
    return {};
  }
}

}  // namespace skyquilt::prepare::input
