#include "core/image/depth_code.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "core/base/deflate.h"
#include "core/base/errors.h"

namespace skyquilt::image {
namespace {

constexpr double kDepthSteps = 65534.0;

// What is spread evenly over the numbers: at q = 1, and from there to q = 65535.
struct EvenScale {
  EvenScale(DepthRange depths, DepthScale scale) : inverse(scale == DepthScale::kInverse) {
    const auto near_m = static_cast<double>(depths.near_m), far_m = static_cast<double>(depths.far_m);
    first = inverse ? 1.0 / far_m : near_m;
    range = inverse ? 1.0 / near_m - 1.0 / far_m : far_m - near_m;
  }
  bool inverse;
  double first = 0.0, range = 0.0;
};

}  // namespace

std::vector<float> HalfDepths(std::span<const float> depth_m, int width, int height, DepthScale scale) {
  SKYQUILT_CHECK(depth_m.size() == static_cast<size_t>(width) * static_cast<size_t>(height), std::to_string(depth_m.size()) + " depths");
  std::vector<float> reduced;
  reduced.reserve(static_cast<size_t>(HalfOf(width)) * static_cast<size_t>(HalfOf(height)));
  for (int row = 0; row < height; row += 2) {
    for (int column = 0; column < width; column += 2) {
      const float d = depth_m[static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column)];
      const bool good = std::isfinite(d) && (scale == DepthScale::kLinear || d > 0.0F);
      reduced.push_back(good ? d : std::numeric_limits<float>::quiet_NaN());
    }
  }
  return reduced;
}

std::optional<DepthRange> RangeOfDepths(std::span<const float> depth_m) {
  std::optional<DepthRange> range;
  for (const float d : depth_m) {
    if (std::isnan(d)) continue;
    if (!range) range = DepthRange{d, d};
    range->near_m = std::min(range->near_m, d);
    range->far_m = std::max(range->far_m, d);
  }
  return range;
}

std::string PackDepths(std::span<const float> depth_m, DepthRange range, DepthScale scale) {
  const EvenScale even(range, scale);
  std::string raw(2 * depth_m.size(), '\0');
  for (size_t i = 0; i < depth_m.size(); ++i) {
    if (std::isnan(depth_m[i])) continue;
    const auto d = static_cast<double>(depth_m[i]);
    const double share = even.range > 0.0 ? ((even.inverse ? 1.0 / d : d) - even.first) / even.range : 0.0;
    const auto q = static_cast<uint16_t>(1 + std::lround(std::clamp(share, 0.0, 1.0) * kDepthSteps));
    raw[2 * i] = static_cast<char>(q & 0xFFU);
    raw[2 * i + 1] = static_cast<char>(q >> 8U);
  }
  return base::Deflate(raw);
}

std::vector<float> UnpackDepths(std::string_view packed, size_t n, DepthRange range, DepthScale scale) {
  if (!std::isfinite(range.near_m) || !std::isfinite(range.far_m) || range.far_m < range.near_m ||
      (scale == DepthScale::kInverse && !(range.near_m > 0.0F))) {
    throw std::runtime_error("near and far are no range");
  }
  const EvenScale even(range, scale);
  const std::string raw = base::Inflate(packed, 2 * n);
  std::vector<float> depth_m(n, std::numeric_limits<float>::quiet_NaN());
  for (size_t i = 0; i < n; ++i) {
    const unsigned q = static_cast<unsigned char>(raw[2 * i]) | static_cast<unsigned>(static_cast<unsigned char>(raw[2 * i + 1])) << 8U;
    if (q == 0) continue;
    const double value = even.first + (q - 1) / kDepthSteps * even.range;
    depth_m[i] = static_cast<float>(even.inverse ? 1.0 / value : value);
  }
  return depth_m;
}

}  // namespace skyquilt::image
