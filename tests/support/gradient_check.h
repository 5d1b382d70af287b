// Checks an analytic gradient against central differences in double.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace skyquilt::testing {

// Every entry of `analytic`, the gradient of value at x, must agree within tolerance, relative to the larger of 1 and its size. Uses the best of
// several step sizes: large ones have truncation errors, small ones rounding errors.
inline void ExpectGradient(const std::function<double(const std::vector<double>&)>& value, std::vector<double> x, const std::vector<double>& analytic,
                           double tolerance = 1e-6) {
  ASSERT_EQ(x.size(), analytic.size());
  for (size_t i = 0; i < x.size(); ++i) {
    double best = 1e300;
    double best_numeric = 0.0;
    for (const double h : {1e-3, 1e-4, 1e-5, 1e-6}) {
      const double keep = x[i];
      x[i] = keep + h;
      const double above = value(x);
      x[i] = keep - h;
      const double below = value(x);
      x[i] = keep;
      const double numeric = (above - below) / (2.0 * h);
      const double error = std::abs(numeric - analytic[i]) / std::max({1.0, std::abs(numeric), std::abs(analytic[i])});
      if (error < best) {
        best = error;
        best_numeric = numeric;
      }
    }
    EXPECT_LE(best, tolerance) << "entry " << i << ": analytic " << analytic[i] << ", numeric " << best_numeric;
  }
}

}  // namespace skyquilt::testing
