#include "tour/pictures/picture_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::tour {
namespace {

constexpr std::string_view kPictureMagic = "SQPICT01";
constexpr size_t kKeyChars = 16;
constexpr int kPngLevel = 3;  // as image::SavePng, with which `skyquilt render` writes its pictures
// The nearest depths, at most this share of all, count as the next nearest one. Else a speck of density before the eye would leave hardly any numbers
// for the rest.
constexpr double kSpecks = 1e-3;
constexpr float kNearestOfFarthest = 1e-4F;  // for the same reason, when much is very near

// Without gaps between the members.
struct PictureHeader {
  int32_t width = 0, height = 0, depth_width = 0, depth_height = 0;
  float near_m = 0.0F, far_m = 0.0F;
  uint64_t png_bytes = 0, depth_bytes = 0;
};
static_assert(sizeof(PictureHeader) == 40 && std::is_trivially_copyable_v<PictureHeader>);

std::optional<image::DepthRange> RangeWithoutSpecks(const std::vector<float>& depth_m) {
  std::optional<image::DepthRange> range = image::RangeOfDepths(depth_m);
  if (!range) return range;
  std::vector<float> depths;
  std::copy_if(depth_m.begin(), depth_m.end(), std::back_inserter(depths), [](float d) { return !std::isnan(d); });
  const auto nearest = depths.begin() + static_cast<std::ptrdiff_t>(kSpecks * static_cast<double>(depths.size()));
  std::nth_element(depths.begin(), nearest, depths.end());
  range->near_m = std::max(*nearest, kNearestOfFarthest * range->far_m);
  return range;
}

}  // namespace

StoredPicture Encode(const RenderedPicture& picture) {
  StoredPicture stored;
  stored.width = picture.color.width;
  stored.height = picture.color.height;
  stored.png = image::EncodePng(picture.color, kPngLevel);
  stored.depth_width = image::HalfOf(stored.width);
  stored.depth_height = image::HalfOf(stored.height);
  const std::vector<float> depths = image::HalfDepths(picture.depth_m, stored.width, stored.height, image::DepthScale::kInverse);
  if (const std::optional<image::DepthRange> range = RangeWithoutSpecks(depths)) {
    stored.range = *range;
    stored.depth = image::PackDepths(depths, stored.range, image::DepthScale::kInverse);
  }
  return stored;
}

image::Image8 ColorsOf(const StoredPicture& picture) {
  return image::DecodeRgb8({reinterpret_cast<const uint8_t*>(picture.png.data()), picture.png.size()});
}

std::string PictureFileName(const std::string& key) {
  return key + ".picture";
}

void SavePicture(const StoredPicture& picture, const std::string& key, const std::filesystem::path& file) {
  SKYQUILT_CHECK(key.size() == kKeyChars, key);
  const PictureHeader header{picture.width,        picture.height,      picture.depth_width, picture.depth_height,
                             picture.range.near_m, picture.range.far_m, picture.png.size(),  picture.depth.size()};
  std::string content(kPictureMagic);
  content.append(key).append(reinterpret_cast<const char*>(&header), sizeof(header)).append(picture.png).append(picture.depth);
  content.append(base::HashHex(content));
  base::WriteFileAtomically(file, content);
}

std::optional<StoredPicture> LoadPicture(const std::filesystem::path& file, const std::string& key) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
  const std::string text = base::ReadFile(file);
  const std::string preamble = std::string(kPictureMagic) + key;
  PictureHeader header;
  const size_t begin = preamble.size() + sizeof(header);
  if (text.size() < begin + kKeyChars || !text.starts_with(preamble)) return std::nullopt;
  const std::string_view content = std::string_view(text).substr(0, text.size() - kKeyChars);
  if (base::HashHex(content) != std::string_view(text).substr(content.size())) return std::nullopt;
  std::memcpy(&header, text.data() + preamble.size(), sizeof(header));
  const std::string_view parts = content.substr(begin);
  if (header.png_bytes > parts.size() || header.depth_bytes != parts.size() - header.png_bytes) return std::nullopt;
  StoredPicture picture;
  picture.width = header.width;
  picture.height = header.height;
  picture.depth_width = header.depth_width;
  picture.depth_height = header.depth_height;
  picture.range = {header.near_m, header.far_m};
  picture.png = parts.substr(0, header.png_bytes);
  picture.depth = parts.substr(header.png_bytes);
  return picture;
}

StoredPicture OpenPicture(const std::filesystem::path& file) {
  std::optional<StoredPicture> picture = LoadPicture(file, file.stem().string());
  if (!picture) throw base::InputError(file, "is missing or damaged", "Run the command again; it renders this picture again");
  return std::move(*picture);
}

}  // namespace skyquilt::tour
