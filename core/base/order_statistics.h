// Medians and quantiles of unsorted samples. Values must not be NaN.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace skyquilt::base {

// The index-th smallest value, counted from 0; index < values.size(). Reorders the values.
template <typename T>
const T& OrderStatistic(std::vector<T>& values, size_t index) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(index);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

// The median; for an even number of values the upper of the two middle ones. Reorders the values; there must be at least one.
template <typename T>
const T& UpperMedian(std::vector<T>& values) {
  return OrderStatistic(values, values.size() / 2);
}

// The share quantile without interpolation: the value whose rank is nearest to share * (n - 1), share in [0, 1]. Reorders the values; there must be
// at least one.
template <typename T>
const T& NearestRankQuantile(std::vector<T>& values, double share) {
  return OrderStatistic(values, static_cast<size_t>(std::lround(share * static_cast<double>(values.size() - 1))));
}

// The share quantile, linear between neighbouring ranks; share is clamped to [0, 1]. NaN when there are no values. Takes a copy because it reorders.
inline double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const double lower = std::floor(position);
  const auto index = static_cast<size_t>(lower);
  const double low = OrderStatistic(values, index);
  if (position == lower) return low;
  const double high = *std::min_element(values.begin() + static_cast<std::ptrdiff_t>(index) + 1, values.end());
  return low + (position - lower) * (high - low);
}

inline double Median(std::vector<double> values) {
  return Quantile(std::move(values), 0.5);
}

// Standard deviation of normal noise over its median absolute value.
inline constexpr double kMadToSigma = 1.4826;

// Normalised median absolute deviation: the standard deviation that normal values with this median distance from their median have. NaN when there
// are no values.
inline double Nmad(std::vector<double> values) {
  const double median = Median(values);
  for (double& value : values) value = std::abs(value - median);
  return kMadToSigma * Median(std::move(values));
}

}  // namespace skyquilt::base
