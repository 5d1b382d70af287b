#include "prepare/input/white_level.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::prepare::input {
namespace {

// Of the tag's white: tags that are exceeded by more are wrong.
constexpr double kTagTolerance = 1.01;
constexpr double kLargestUnit = 1.5;  // of photos whose white is 1: some programs leave lights above it

std::optional<double> TaggedWhite(const PhotoRange& photo) {
  if (photo.white) return photo.white;
  if (!photo.floating && photo.bits > 8 && photo.bits < 16) return std::exp2(photo.bits) - 1.0;
  return std::nullopt;
}

std::string PhotosText(size_t n) {
  return fmt::format("{} photo{}", n, n == 1 ? "" : "s");
}

}  // namespace

WhiteLevel FindWhite(std::span<const PhotoRange> photos) {
  SKYQUILT_CHECK(!photos.empty(), "no photos");
  double largest = 0.0, tagged = 0.0;
  bool all_tagged = true, any_floating = false;
  for (const PhotoRange& photo : photos) {
    largest = std::max(largest, photo.largest);
    any_floating = any_floating || photo.floating;
    const std::optional<double> white = TaggedWhite(photo);
    all_tagged = all_tagged && white;
    tagged = std::max(tagged, white.value_or(0.0));
  }
  if (all_tagged && tagged > 0.0 && largest <= kTagTolerance * tagged) {
    return {tagged, fmt::format("by the tags of {}, whose largest value is {:g}", PhotosText(photos.size()), largest)};
  }
  const std::string by = fmt::format("by the largest value in {} ({:g})", PhotosText(photos.size()), largest);
  if (any_floating && largest <= kLargestUnit) return {1.0, by};
  constexpr std::array kBits = {8, 10, 12, 14, 16, 20, 24, 32};
  for (const int bits : kBits) {
    // Some programs scale to 4096 instead of 4095.
    if (largest <= std::exp2(bits)) return {std::exp2(bits) - 1.0, fmt::format("{} bits, {}", bits, by)};
  }
  return {largest, by};
}

}  // namespace skyquilt::prepare::input
