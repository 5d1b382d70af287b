// Central differences in double against an analytic gradient.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace skyquilt::testing {

// value(x) is differentiated at x; every entry of `analytic` must agree within tolerance, relative to the larger of 1 and its size.
// The best of several step sizes counts: too large bends, too small rounds.
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
