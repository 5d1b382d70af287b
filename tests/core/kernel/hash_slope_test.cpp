// Derivatives of the hash grid's features by position, against differences in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "core/base/random.h"
#include "core/kernel/kernels.h"
#include "core/kernel/reference.h"
#include "tests/core/kernel/small_level.h"
#include "tests/support/each_instruction_set.h"
#include "tests/support/not_finite.h"

namespace skyquilt::kernel {
namespace {

using HashSlopeKernels = testing::EachInstructionSet;
SKYQUILT_EACH_INSTRUCTION_SET(HashSlopeKernels);

constexpr size_t kBatchSamples = 300;  // more than one block, and no whole number of vectors

// Samples with gradients of their features and directions to move in.
struct Batch {
  Batch(int n_points, int n_features, bool dense, uint64_t seed)
      : level(LevelOf(dense)), features(n_features), points(n_points), plane(kBatchSamples + 3) {
    base::Random random(seed);
    const auto fill = [&](std::vector<float>* v, size_t n, float low, float high) {
      v->resize(n);
      for (float& value : *v) value = low + (high - low) * random.Uniform();
    };
    const size_t positions = plane * static_cast<size_t>(points);
    fill(&x, positions, 0.0F, 1.0F);
    fill(&y, positions, 0.0F, 1.0F);
    fill(&z, positions, 0.0F, 4.0F / 9.0F);
    fill(&sharpness, kBatchSamples, 2.0F, 40.0F);
    sharpness[1] = 0.0F;
    sharpness[2] = kInfinityFloat;
    // Clamped on one axis.
    x[3] = -0.01F;
    z[4] = 0.47F;
    fill(&table, level.entries * static_cast<size_t>(features), -0.5F, 0.5F);
    fill(&out_gradient, kBatchSamples * static_cast<size_t>(features), -0.5F, 0.5F);
    fill(&along, 3 * kBatchSamples, -1.0F, 1.0F);
  }
  Positions At() const { return {x.data(), y.data(), z.data(), sharpness.data(), points, plane}; }

  // Features of a sample whose positions are moved by `step`, from any table.
  std::vector<double> Features(size_t s, const std::array<double, 3>& step, const std::vector<double>& of) const {
    std::vector<std::array<double, 3>> positions;
    for (size_t i = s; i < x.size(); i += plane) {
      positions.push_back({static_cast<double>(x[i]) + step[0], static_cast<double>(y[i]) + step[1], static_cast<double>(z[i]) + step[2]});
    }
    return reference::HashForward(level, features, of, positions, static_cast<double>(sharpness[s]));
  }
  // Their growth along a direction, by a central difference. The features are at most cubic along a line inside a cell, so small steps are exact
  // enough; NaN where the sample is so near a cell's face that the two sides differ.
  std::vector<double> Growth(size_t s, const std::array<double, 3>& u, const std::vector<double>& of) const {
    constexpr double kStep = 1e-6;
    const std::vector<double> here = Features(s, {0, 0, 0}, of);
    const std::vector<double> after = Features(s, {kStep * u[0], kStep * u[1], kStep * u[2]}, of);
    const std::vector<double> before = Features(s, {-kStep * u[0], -kStep * u[1], -kStep * u[2]}, of);
    std::vector<double> growth;
    for (size_t f = 0; f < here.size(); ++f) {
      const double rising = (after[f] - here[f]) / kStep, falling = (here[f] - before[f]) / kStep;
      growth.push_back(std::abs(rising - falling) < 1e-3 ? 0.5 * (rising + falling) : std::numeric_limits<double>::quiet_NaN());
    }
    return growth;
  }
  std::array<double, 3> Along(size_t s) const {
    return {static_cast<double>(along[s]), static_cast<double>(along[kBatchSamples + s]), static_cast<double>(along[2 * kBatchSamples + s])};
  }
  double OutGradient(size_t f, size_t s) const { return static_cast<double>(out_gradient[f * kBatchSamples + s]); }
  std::vector<double> Table() const { return {table.begin(), table.end()}; }

  GridLevel level;
  int features, points;
  size_t plane;
  std::vector<float> x, y, z, sharpness, table, out_gradient, along;
};

// Calls body(batch) for dense and hashed levels, both entry sizes and every number of positions.
template <typename Body>
void ForEveryShape(const Body& body) {
  for (const bool dense : {true, false}) {
    for (const int features : {2, 4}) {
      for (const int points : {1, 4, 6}) body(Batch(points, features, dense, 7));
    }
  }
}

TEST_P(HashSlopeKernels, SlopeMatchesDifferencesOfTheFeatures) {
  ForEveryShape([](const Batch& batch) {
    std::vector<float> slope(3 * kBatchSamples + 1, 0.25F);  // results are added
    HashSlope(batch.level, batch.features, batch.table.data(), batch.At(), kBatchSamples, batch.out_gradient.data(), kBatchSamples, slope.data(),
              kBatchSamples);
    const std::vector<double> table = batch.Table();
    size_t compared = 0;
    for (size_t s = 0; s < kBatchSamples; ++s) {
      for (size_t axis = 0; axis < 3; ++axis) {
        std::array<double, 3> unit = {0, 0, 0};
        unit[axis] = 1.0;
        const std::vector<double> growth = batch.Growth(s, unit, table);
        double expected = 0.25;
        for (size_t f = 0; f < growth.size(); ++f) expected += batch.OutGradient(f, s) * growth[f];
        if (std::isnan(expected)) continue;
        EXPECT_NEAR(static_cast<double>(slope[axis * kBatchSamples + s]), expected, 5e-5) << s << " axis " << axis;
        ++compared;
      }
    }
    EXPECT_GT(compared, 3 * kBatchSamples - 10);
    if (batch.points == 1) {
      EXPECT_EQ(slope[3], 0.25F) << "clamped along x";
      EXPECT_NE(slope[kBatchSamples + 3], 0.25F) << "free along y";
      EXPECT_EQ(slope[2 * kBatchSamples + 4], 0.25F) << "clamped along z";
    }
    EXPECT_EQ(slope.back(), 0.25F) << "nothing after the last row";
  });
}

TEST_P(HashSlopeKernels, TangentMatchesDifferencesOfTheFeatures) {
  ForEveryShape([](const Batch& batch) {
    std::vector<float> out(static_cast<size_t>(batch.features) * kBatchSamples + 1, 9.0F);
    HashTangent(batch.level, batch.features, batch.table.data(), batch.At(), kBatchSamples, batch.along.data(), kBatchSamples, out.data(),
                kBatchSamples);
    const std::vector<double> table = batch.Table();
    size_t compared = 0;
    for (size_t s = 0; s < kBatchSamples; ++s) {
      const std::vector<double> growth = batch.Growth(s, batch.Along(s), table);
      for (size_t f = 0; f < growth.size(); ++f) {
        if (std::isnan(growth[f])) continue;
        EXPECT_NEAR(static_cast<double>(out[f * kBatchSamples + s]), growth[f], 5e-5) << s;
        ++compared;
      }
    }
    EXPECT_GT(compared, static_cast<size_t>(batch.features) * (kBatchSamples - 10));
    EXPECT_EQ(out.back(), 9.0F);
  });
}

// The tangent is linear in the table, so its derivative by an entry is the tangent of a table that is 1 there and 0 elsewhere.
TEST_P(HashSlopeKernels, TangentBackwardMatchesTheTangentOfUnitTables) {
  ForEveryShape([](const Batch& batch) {
    std::vector<float> gradient(batch.table.size(), 0.0F);
    std::vector<uint8_t> touched(gradient.size() / kLineFloats + 1, 0);
    HashTangentBackward(batch.level, batch.features, batch.At(), kBatchSamples, batch.along.data(), kBatchSamples, batch.out_gradient.data(),
                        kBatchSamples, gradient.data(), touched.data());
    for (size_t entry = 0; entry < batch.level.entries; entry += 17) {
      std::vector<float> unit(batch.table.size(), 0.0F), out(static_cast<size_t>(batch.features) * kBatchSamples);
      const auto features = static_cast<size_t>(batch.features);
      for (size_t f = 0; f < features; ++f) unit[entry * features + f] = 1.0F;
      HashTangent(batch.level, batch.features, unit.data(), batch.At(), kBatchSamples, batch.along.data(), kBatchSamples, out.data(), kBatchSamples);
      for (size_t f = 0; f < features; ++f) {
        double expected = 0.0;
        for (size_t s = 0; s < kBatchSamples; ++s) expected += batch.OutGradient(f, s) * static_cast<double>(out[f * kBatchSamples + s]);
        EXPECT_NEAR(static_cast<double>(gradient[entry * features + f]), expected, 2e-4 * std::max(1.0, std::abs(expected)));
      }
    }
  });
}

TEST_P(HashSlopeKernels, TangentBackwardMarksExactlyTheLinesItWroteAndSkipsSamplesThatDoNotMove) {
  Batch batch(1, 4, false, 9);
  batch.level.entries = 1U << 14U;
  std::vector<float> gradient(size_t{1 << 14} * 4, 0.0F);
  std::vector<uint8_t> touched(gradient.size() / kLineFloats, 0);
  constexpr int64_t kFew = 20;
  for (size_t axis = 0; axis < 3; ++axis) std::fill_n(batch.along.begin() + static_cast<ptrdiff_t>(axis * kBatchSamples), kFew / 2, 0.0F);
  const auto lines = [&] { return std::accumulate(touched.begin(), touched.end(), 0); };
  const auto backward = [&](int64_t n) {
    HashTangentBackward(batch.level, 4, batch.At(), n, batch.along.data(), kBatchSamples, batch.out_gradient.data(), kBatchSamples, gradient.data(),
                        touched.data());
  };
  backward(kFew / 2);
  EXPECT_EQ(lines(), 0);
  backward(kFew);
  EXPECT_GT(lines(), 10);
  for (size_t line = 0; line < touched.size(); ++line) {
    const auto first = gradient.begin() + static_cast<ptrdiff_t>(line * kLineFloats);
    EXPECT_EQ(touched[line] != 0, std::any_of(first, first + kLineFloats, [](float g) { return g != 0.0F; })) << line;
  }
}

TEST_P(HashSlopeKernels, PositionsThatAreNoNumberDoNotMove) {
  const GridLevel level = LevelOf(true);
  const std::vector<float> table(level.entries * 2, 0.25F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float along[3] = {1.0F, 1.0F, 1.0F}, out_gradient[2] = {1.0F, 1.0F};
  float out[2], slope[3] = {0.0F, 0.0F, 0.0F};
  HashTangent(level, 2, table.data(), {&nan, &nan, &nan}, 1, along, 1, out, 1);
  HashSlope(level, 2, table.data(), {&nan, &nan, &nan}, 1, out_gradient, 1, slope, 1);
  for (const float value : {out[0], out[1], slope[0], slope[1], slope[2]}) EXPECT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace skyquilt::kernel
