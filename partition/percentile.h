// Percentiles of unsorted numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace skyquilt::partition {

// Linear between the order statistics; share in [0, 1]. NaN when there is nothing. Takes a copy because it reorders.
inline double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto lower = static_cast<std::ptrdiff_t>(std::floor(position));
  std::nth_element(values.begin(), values.begin() + lower, values.end());
  const double low = values[static_cast<size_t>(lower)];
  const double rest = position - static_cast<double>(lower);
  if (rest == 0.0) return low;
  const double high = *std::min_element(values.begin() + lower + 1, values.end());
  return low + rest * (high - low);
}

}  // namespace skyquilt::partition
