#include "buildings/fit/correlation.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace skyquilt::buildings {
namespace {

constexpr size_t kMostPairedPoints = 500;  // pairs grow with the square
constexpr size_t kLags = 16;
constexpr size_t kLeastPairs = 15;
constexpr double kUncorrelated = 0.1;

}  // namespace

double CorrelationArea(std::span<const Eigen::Vector2d> at, std::span<const double> residuals, double area_m2) {
  const size_t n = at.size();
  if (n < 3 || !(area_m2 > 0.0)) return std::max(area_m2, 0.0);
  const double share_m2 = area_m2 / static_cast<double>(n);
  const size_t step = (n + kMostPairedPoints - 1) / kMostPairedPoints;
  double variance = 0.0, mean = 0.0;
  for (const double r : residuals) mean += r / static_cast<double>(n);
  for (const double r : residuals) variance += (r - mean) * (r - mean) / static_cast<double>(n);
  if (!(variance > 0.0)) return share_m2;

  Eigen::Vector2d low = at[0], high = at[0];
  for (const Eigen::Vector2d& place : at) {
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  const double lag = 0.5 * std::max((high - low).norm(), 1e-6) / static_cast<double>(kLags);
  std::array<double, kLags> product{}, pairs{};
  for (size_t i = 0; i < n; i += step) {
    for (size_t k = i + step; k < n; k += step) {
      const double bin = (at[i] - at[k]).norm() / lag;
      if (!(bin < static_cast<double>(kLags))) continue;
      const auto b = static_cast<size_t>(bin);
      product[b] += (residuals[i] - mean) * (residuals[k] - mean);
      pairs[b] += 1.0;
    }
  }
  double integral = 0.0;
  for (size_t b = 0; b < kLags; ++b) {
    const double middle = (static_cast<double>(b) + 0.5) * lag;
    if (pairs[b] < static_cast<double>(kLeastPairs)) continue;
    const double correlation = product[b] / pairs[b] / variance;
    if (correlation < kUncorrelated) break;
    integral += correlation * 2.0 * std::numbers::pi * middle * lag;
  }
  return std::clamp(integral, share_m2, 0.5 * area_m2);
}

}  // namespace skyquilt::buildings
