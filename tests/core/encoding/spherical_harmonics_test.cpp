#include "core/encoding/spherical_harmonics.h"

#include <gtest/gtest.h>

#include "core/base/random.h"

namespace skyquilt::encoding {
namespace {

TEST(SphericalHarmonics, BackwardIsTheDerivativeOfForward) {
  base::Random random(3);
  for (int round = 0; round < 200; ++round) {
    const int degree = 1 + round % 4;
    double at[3], weights[16];
    for (double& c : at) c = random.Uniform(-1.2, 1.2);
    for (double& w : weights) w = random.Normal();
    const auto sum = [&](int axis, double by) {
      double moved[3] = {at[0], at[1], at[2]}, sh[16];
      moved[axis] += by;
      SphericalHarmonics(moved[0], moved[1], moved[2], degree, sh);
      double total = 0.0;
      for (int k = 0; k < degree * degree; ++k) total += weights[k] * sh[k];
      return total;
    };
    double gradient[3] = {1.0, 2.0, 3.0};  // it is added to
    SphericalHarmonicsBackward(at[0], at[1], at[2], degree, weights, gradient);
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kStep = 1e-5;
      EXPECT_NEAR(gradient[axis] - (axis + 1.0), (sum(axis, kStep) - sum(axis, -kStep)) / (2.0 * kStep), 1e-8) << degree << " " << axis;
    }
  }
}

}  // namespace
}  // namespace skyquilt::encoding
