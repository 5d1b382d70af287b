// Footprints of samples in the hash grid: weights of levels, several positions per sample, and their gradients.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/kernel/kernels.h"
#include "core/kernel/reference.h"
#include "tests/core/kernel/small_level.h"
#include "tests/support/each_instruction_set.h"
#include "tests/support/gradient_check.h"
#include "tests/support/not_finite.h"

namespace skyquilt::kernel {
namespace {

using FootprintKernels = testing::EachInstructionSet;
SKYQUILT_EACH_INSTRUCTION_SET(FootprintKernels);

// Samples of 1, 4 or 6 positions with footprints from none to infinite.
struct Samples {
  Samples(int n_points, size_t n, base::Random& random) : points(n_points), plane(n + 3) {
    for (auto* v : {&x, &y, &z}) v->resize(plane * static_cast<size_t>(points));
    for (size_t i = 0; i < x.size(); ++i) {
      x[i] = random.Uniform();
      y[i] = random.Uniform();
      z[i] = 0.5F * random.Uniform();
    }
    for (size_t s = 0; s < n; ++s) sharpness.push_back(9.0F * std::exp2(6.0F * random.Uniform() - 3.0F));
    sharpness[1] = 0.0F;
    sharpness[2] = kInfinityFloat;
  }
  Positions At() const { return {x.data(), y.data(), z.data(), sharpness.data(), points, plane}; }
  std::vector<std::array<double, 3>> Of(size_t s) const {
    std::vector<std::array<double, 3>> positions;
    for (size_t i = s; i < x.size(); i += plane)
      positions.push_back({static_cast<double>(x[i]), static_cast<double>(y[i]), static_cast<double>(z[i])});
    return positions;
  }
  int points;
  size_t plane;
  std::vector<float> x, y, z, sharpness;
};

TEST(FootprintWeight, IsTheErrorFunctionOfVoxelOverFootprint) {
  for (double a = 0.0; a < 5.0; a += 0.0137)
    EXPECT_NEAR(static_cast<double>(FootprintWeight(static_cast<float>(40.0 * a), 40.0F)), std::erf(a), 2e-6) << a;
}

TEST(FootprintWeight, IsOneLessTheHiddenShareOfAnyNumberOfSamples) {
  base::Random random(3);
  for (const int64_t n : {0, 1, 7, 16, 37}) {
    std::vector<float> sharpness(static_cast<size_t>(n)), hidden(static_cast<size_t>(n) + 1, -1.0F);
    for (float& value : sharpness) value = 60.0F * random.Uniform();
    if (n > 2) sharpness[1] = kInfinityFloat;
    FootprintHidden(sharpness.data(), n, 20.0F, hidden.data());
    for (size_t s = 0; s < sharpness.size(); ++s) EXPECT_NEAR(hidden[s], 1.0F - FootprintWeight(sharpness[s], 20.0F), 1e-6F) << n << " " << s;
    EXPECT_EQ(hidden.back(), -1.0F);
  }
}

TEST(FootprintWeight, KnowsPointsAndInfiniteFootprints) {
  EXPECT_EQ(FootprintWeight(kInfinityFloat, 16.0F), 1.0F);
  EXPECT_EQ(FootprintWeight(kNanFloat, 16.0F), 1.0F);
  EXPECT_EQ(FootprintWeight(0.0F, 16.0F), 0.0F);
  EXPECT_EQ(FootprintWeight(1e30F, 16.0F), 1.0F);
}

TEST(FootprintReference, GradientMatchesFiniteDifferencesForEveryNumberOfPositions) {
  base::Random random(3);
  for (const int points : {1, 4, 6}) {
    const Samples samples(points, 8, random);
    const GridLevel level = LevelOf(false);
    std::vector<double> table(level.entries * 2), gradient(table.size(), 0.0);
    for (double& value : table) value = random.Uniform(-1.0, 1.0);
    const std::vector<double> out_gradient = {0.4, -1.1};
    const double sharpness = 7.3;
    reference::HashBackward(level, samples.Of(5), sharpness, out_gradient, &gradient);
    testing::ExpectGradient(
        [&](const std::vector<double>& t) {
          const auto out = reference::HashForward(level, 2, t, samples.Of(5), sharpness);
          return out[0] * out_gradient[0] + out[1] * out_gradient[1];
        },
        table, gradient);
  }
}

TEST_P(FootprintKernels, ForwardAndBackwardAgreeWithReference) {
  base::Random random(5);
  constexpr size_t kSamples = 300;  // more than one block
  for (const bool dense : {true, false}) {
    for (const int points : {1, 4, 6}) {
      for (const size_t features : {2U, 4U}) {
        const GridLevel level = LevelOf(dense);
        const Samples samples(points, kSamples, random);
        std::vector<float> table(level.entries * features), out(features * kSamples), out_gradient(out.size());
        for (float& value : table) value = random.Uniform() - 0.5F;
        for (float& value : out_gradient) value = random.Uniform() - 0.5F;
        std::vector<float> gradient(table.size(), 0.0F);
        std::vector<uint8_t> touched(table.size() / kLineFloats + 1, 0);
        HashForward(level, static_cast<int>(features), table.data(), samples.At(), kSamples, out.data(), kSamples);
        HashBackward(level, static_cast<int>(features), samples.At(), kSamples, out_gradient.data(), kSamples, gradient.data(), touched.data());
        const std::vector<double> exact_table(table.begin(), table.end());
        std::vector<double> exact_gradient(table.size(), 0.0);
        for (size_t s = 0; s < kSamples; ++s) {
          const auto sharpness = static_cast<double>(samples.sharpness[s]);
          const auto exact = reference::HashForward(level, static_cast<int>(features), exact_table, samples.Of(s), sharpness);
          std::vector<double> g;
          for (size_t f = 0; f < features; ++f) {
            EXPECT_NEAR(static_cast<double>(out[f * kSamples + s]), exact[f], 1e-5);
            g.push_back(static_cast<double>(out_gradient[f * kSamples + s]));
          }
          reference::HashBackward(level, samples.Of(s), sharpness, g, &exact_gradient);
        }
        for (size_t i = 0; i < gradient.size(); ++i) EXPECT_NEAR(static_cast<double>(gradient[i]), exact_gradient[i], 2e-4);
      }
    }
  }
}

TEST_P(FootprintKernels, FootprintsOfZeroGiveTheBitsOfPoints) {
  base::Random random(7);
  constexpr size_t kSamples = 37;
  Samples samples(1, kSamples, random);
  samples.sharpness.assign(kSamples, kInfinityFloat);
  const GridLevel level = LevelOf(false);
  std::vector<float> table(level.entries * 4), cones(4 * kSamples), points(4 * kSamples);
  for (float& value : table) value = random.Uniform() - 0.5F;
  HashForward(level, 4, table.data(), samples.At(), kSamples, cones.data(), kSamples);
  HashForward(level, 4, table.data(), {samples.x.data(), samples.y.data(), samples.z.data()}, kSamples, points.data(), kSamples);
  EXPECT_EQ(cones, points);
}

}  // namespace
}  // namespace skyquilt::kernel
