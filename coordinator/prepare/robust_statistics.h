// Order statistics of small samples.
#pragma once

#include <vector>

namespace skyquilt::coordinator {

// Linear between neighbours, share in [0, 1]; NaN when there are no values. Values must not be NaN.
double Quantile(std::vector<double> values, double share);
inline double Median(const std::vector<double>& values) {
  return Quantile(values, 0.5);
}

}  // namespace skyquilt::coordinator
