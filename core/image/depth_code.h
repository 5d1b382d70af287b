// Depths as whole numbers of 16 bits in raw deflate, as frames of the viewer and panoramas of tours carry them. Little-endian, row-major; 0: no
// surface, else q from 1 to 65535:
//   inverse   1 / d = 1 / far + (q - 1) / 65534 (1 / near - 1 / far)   The same parallax per step at any distance.
//   linear        d = near + (q - 1) / 65534 (far - near)              For parallel rays, where d may be negative.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::image {

enum class DepthScale { kInverse, kLinear };

// near_m <= far_m, both finite; kInverse: positive.
struct DepthRange {
  float near_m = 0.0F, far_m = 0.0F;
};

// Every second value of every second row, from the first: half of width and height, rounded up. What is no depth (not finite, and for kInverse also
// not positive) becomes NaN.
std::vector<float> HalfDepths(std::span<const float> depth_m, int width, int height, DepthScale scale);
inline int HalfOf(int size) {
  return (size + 1) / 2;
}

// The smallest and the largest value; nothing when all are NaN.
std::optional<DepthRange> RangeOfDepths(std::span<const float> depth_m);

// Values outside the range count as at its ends. NaN: no surface.
std::string PackDepths(std::span<const float> depth_m, DepthRange range, DepthScale scale);
// n values, NaN where there is no surface. Throws std::runtime_error for damaged bytes and impossible ranges.
std::vector<float> UnpackDepths(std::string_view packed, size_t n, DepthRange range, DepthScale scale);

}  // namespace skyquilt::image
