#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "buildings/fit/ground_level.h"
#include "buildings/fit/height_mode.h"
#include "core/base/random.h"

namespace skyquilt::buildings {
namespace {

TEST(Modes, AreSortedByMassAndPlacedWithinAFractionOfTheBandwidth) {
  base::Random random(2);
  std::vector<double> values;
  for (int i = 0; i < 600; ++i) values.push_back(5.0 + 0.1 * random.Normal());
  for (int i = 0; i < 300; ++i) values.push_back(3.0 + 0.1 * random.Normal());
  const std::vector<Mode> modes = Modes(values, {}, 0.2);
  ASSERT_GE(modes.size(), 2U);
  EXPECT_NEAR(modes[0].at, 5.0, 0.03);
  EXPECT_NEAR(modes[1].at, 3.0, 0.03);
  EXPECT_NEAR(modes[0].mass, 600.0, 5.0);
  EXPECT_NEAR(LowestStrongMode(values, 0.2, 0.4)->at, 3.0, 0.03);
  EXPECT_NEAR(LowestStrongMode(values, 0.2, 0.7)->at, 5.0, 0.03);
  // Weights turn the order.
  std::vector<double> weights(values.size(), 0.1);
  for (size_t i = 600; i < weights.size(); ++i) weights[i] = 1.0;
  EXPECT_NEAR(Modes(values, weights, 0.2).front().at, 3.0, 0.03);
}

TEST(Modes, OfFewValues) {
  EXPECT_TRUE(Modes({}, {}, 0.2).empty());
  EXPECT_FALSE(LowestStrongMode({}, 0.2, 0.5));
  const std::vector<double> one = {7.5};
  ASSERT_EQ(Modes(one, {}, 0.2).size(), 1U);
  EXPECT_NEAR(Modes(one, {}, 0.2)[0].at, 7.5, 0.05);
  const std::vector<double> far = {-1e7, 1e7};
  EXPECT_EQ(Modes(far, {}, 0.2).size(), 2U);
}

std::vector<FitPoint> Ring(double slope, double noise_m, bool one_side, uint64_t seed) {
  base::Random random(seed);
  std::vector<FitPoint> points;
  for (double x = -9; x <= 9; x += 0.4) {
    for (double y = -8; y <= 8; y += 0.4) {
      if ((std::abs(x) < 6.5 && std::abs(y) < 5.5) || (one_side && x < 6.5)) continue;
      FitPoint point;
      point.place = {x, y};
      point.z = 2.0 + slope * x + noise_m * random.Normal();
      points.push_back(point);
    }
  }
  return points;
}

TEST(GroundLevel, IsThePlaneAtTheMiddle) {
  const Measure level = GroundLevel(Ring(0.05, 0.05, false, 1), {1.0, 0.5}, 0.1, 0.4);
  EXPECT_NEAR(level.value, 2.05, 0.02);
  EXPECT_GT(level.sigma, 0.01);
  EXPECT_LT(level.sigma, 0.1);
}

TEST(GroundLevel, BushesAndCarsAreOutliers) {
  std::vector<FitPoint> points = Ring(0.0, 0.05, false, 2);
  for (size_t i = 0; i < points.size(); i += 4) points[i].z += 0.9;
  EXPECT_NEAR(GroundLevel(points, {0, 0}, 0.1, 0.4).value, 2.0, 0.04);
}

TEST(GroundLevel, OnOneSideIsLessCertain) {
  const Measure all = GroundLevel(Ring(0.0, 0.1, false, 3), {0, 0}, 0.1, 0.4);
  const Measure some = GroundLevel(Ring(0.0, 0.1, true, 3), {0, 0}, 0.1, 0.4);
  EXPECT_GT(some.sigma, 1.5 * all.sigma);
  EXPECT_NEAR(some.value, 2.0, 3.0 * some.sigma);
}

TEST(GroundLevel, OfFewPointsIsUnknown) {
  EXPECT_TRUE(std::isnan(GroundLevel({}, {0, 0}, 0.1, 0.4).value));
  std::vector<FitPoint> same(20);
  for (FitPoint& point : same) {
    point.place = {3, 3};
    point.z = 1.0;
  }
  EXPECT_NEAR(GroundLevel(same, {3, 3}, 0.1, 0.4).value, 1.0, 1e-6);
  EXPECT_TRUE(std::isfinite(GroundLevel(same, {0, 0}, 0.1, 0.4).sigma));
}

}  // namespace
}  // namespace skyquilt::buildings
