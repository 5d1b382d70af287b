// Gains that make photos agree in brightness and colour where they show the same places (as in panoramas: Brown and Lowe 2007, section 6).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace skyquilt::products {

// A place that two photos show: natural logarithm of the light in photo `first` over that in photo `second`, per colour.
struct OverlapRatio {
  int32_t first = 0;
  int32_t second = 0;
  std::array<float, 3> log_ratio{};
};

// Per photo and colour the natural logarithm g of a factor on linear light. Minimises sum_pairs n (m + g_first - g_second)^2 + s sum_photos g^2,
// with m the median of a pair's n ratios, by conjugate gradients; s is small, and the mean over connected photos is 0. Photos without a pair get 0.
// Non-finite ratios are left out.
std::vector<std::array<float, 3>> GainsOfOverlaps(size_t photos, const std::vector<OverlapRatio>& ratios);

}  // namespace skyquilt::products
