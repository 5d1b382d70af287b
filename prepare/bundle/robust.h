// Small tools of robust estimation, shared by the parts of the geo-reference.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace skyquilt::prepare::bundle {

// Median length of a vector of two components, each of normal noise with standard deviation 1.
constexpr double kRayleighMedian = 1.17741;

// Tukey's biweight for a residual in standard deviations: 1 at 0, 0 beyond 4.685, 95 % as efficient as least squares on normal noise.
inline double TukeyWeight(double residual) {
  constexpr double kLimit = 4.685;
  const double u = residual / kLimit;
  return std::abs(u) < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
}

// Serial correlation of residuals that are added in the order of time. Neighbours that err alike carry less information than their number says.
class SerialCorrelation {
 public:
  // `series`: 0 to 2, for instance the axis of the residual.
  void Add(size_t series, double residual) {
    sum_squares_ += residual * residual;
    if (count_[series] > 0) products_ += residual * last_[series];
    last_[series] = residual;
    ++count_[series];
  }
  // Factor on the variance of a mean of the residuals: (1 + r) / (1 - r) for a first-order process of correlation r in [0, 0.98]. The sample
  // correlation of residuals about their mean is too small by (1 + 3 r) / n (Marriott and Pope 1954). Never more than n, for a mean is at least as
  // good as one residual.
  double VarianceFactor() const {
    const int n = *std::max_element(count_.begin(), count_.end());
    if (n == 0 || !(sum_squares_ > 0.0)) return 1.0;
    const double sample = products_ / sum_squares_;
    const double r = std::clamp(sample + (1.0 + 3.0 * sample) / n, 0.0, 0.98);
    return std::min((1.0 + r) / (1.0 - r), static_cast<double>(n));
  }

 private:
  double sum_squares_ = 0.0, products_ = 0.0;
  std::array<double, 3> last_{};
  std::array<int, 3> count_{};
};

}  // namespace skyquilt::prepare::bundle
