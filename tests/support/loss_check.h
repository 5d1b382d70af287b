// A checker for all training losses (worker/losses/): compares analytic derivatives with central differences in double, at random inputs.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "tests/support/gradient_check.h"

namespace skyquilt::testing {

struct CheckedLoss {
  double value = 0.0;
  std::vector<double> gradient;  // by every input
};

// Range of the random inputs, the same for all; should not contain points where the loss is not differentiable.
struct InputRange {
  size_t count = 1;
  double low = 0.0, high = 1.0;
};

// Checks loss(weight, inputs) at `trials` random inputs with random weights. The loss must also be proportional to its weight, so that weight 0
// switches it off.
inline void ExpectLossGradient(const std::function<CheckedLoss(double weight, const std::vector<double>& inputs)>& loss, const InputRange& range,
                               int trials = 50, double tolerance = 1e-6) {
  base::Random random(2024);
  bool ever_matters = false;
  for (int trial = 0; trial < trials; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const double weight = random.Uniform(0.1, 2.0);
    std::vector<double> inputs(range.count);
    for (double& x : inputs) x = random.Uniform(range.low, range.high);
    const CheckedLoss at = loss(weight, inputs);
    ExpectGradient([&](const std::vector<double>& x) { return loss(weight, x).value; }, inputs, at.gradient, tolerance);
    const CheckedLoss twice = loss(2.0 * weight, inputs), without = loss(0.0, inputs);
    EXPECT_NEAR(twice.value, 2.0 * at.value, 1e-12 * (1.0 + std::abs(at.value)));
    EXPECT_EQ(without.value, 0.0);
    for (size_t i = 0; i < range.count; ++i) {
      EXPECT_NEAR(twice.gradient[i], 2.0 * at.gradient[i], 1e-12 * (1.0 + std::abs(at.gradient[i])));
      EXPECT_EQ(without.gradient[i], 0.0);
      ever_matters = ever_matters || at.gradient[i] != 0.0;
    }
  }
  EXPECT_TRUE(ever_matters) << "no input had a gradient: nothing was checked";
}

}  // namespace skyquilt::testing
