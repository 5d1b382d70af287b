#include "core/geo/ray_box.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/random.h"

namespace skyquilt::geo {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Eigen::Vector3d kMin(-1.0, -2.0, 0.0), kMax(3.0, 2.0, 5.0);
const Eigen::Vector3d kLow(-1, -2, -3), kHigh(4, 5, 6);

double Drawn(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1000001) / 1e6;
}
Eigen::Vector3d Anywhere(double reach) {
  return {Drawn(-reach, reach), Drawn(-reach, reach), Drawn(-reach, reach)};
}

TEST(RayBox, IntervalEndsAreOnTheBox) {
  base::Random random(37);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d origin{random.Uniform(-10, 10), random.Uniform(-10, 10), random.Uniform(-10, 10)};
    const Eigen::Vector3d direction = Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()}.normalized();
    const Interval s = RayBox(origin, direction, kMin, kMax);
    if (s.Empty()) {
      // No point of the ray is inside.
      for (double t = 0.0; t < 30.0; t += 0.05) {
        const Eigen::Vector3d p = origin + t * direction;
        EXPECT_FALSE(((p - kMin).array() > 1e-2).all() && ((kMax - p).array() > 1e-2).all());
      }
      continue;
    }
    ++hits;
    const Eigen::Vector3d middle = origin + 0.5 * (s.t_near + s.t_far) * direction;
    EXPECT_TRUE(((middle - kMin).array() >= -1e-9).all() && ((kMax - middle).array() >= -1e-9).all());
    const Eigen::Vector3d out = origin + (s.t_far + 1e-6) * direction;
    EXPECT_TRUE(((out - kMin).array() < 0.0).any() || ((kMax - out).array() < 0.0).any());
  }
  EXPECT_GT(hits, 100);
}

TEST(RayBox, EdgesAreLegal) {
  EXPECT_DOUBLE_EQ(RayBox({0, 0, 1}, {0, 0, 1}, kMin, kMax).t_far, 4.0);  // starts inside
  EXPECT_FALSE(RayBox({-5, -2, 1}, {1, 0, 0}, kMin, kMax).Empty());       // runs along a face
  EXPECT_TRUE(RayBox({-5, -2.001, 1}, {1, 0, 0}, kMin, kMax).Empty());    // just misses it
  EXPECT_TRUE(RayBox({0, 0, 9}, {0, 0, 1}, kMin, kMax).Empty());          // behind the origin
  EXPECT_TRUE(RayBox({kNan, 0, 1}, {0, 0, 1}, kMin, kMax).Empty());
  EXPECT_TRUE(RayBox({0, 0, 1}, {kNan, kNan, kNan}, kMin, kMax).Empty() || !std::isnan(RayBox({0, 0, 1}, {kNan, kNan, kNan}, kMin, kMax).t_near));
}

RC_GTEST_PROP(RayHitsBox, TowardsAPointInside, ()) {
  const Eigen::Vector3d origin = Anywhere(50.0);
  const Eigen::Vector3d target(Drawn(-0.99, 3.99), Drawn(-1.99, 4.99), Drawn(-2.99, 5.99));
  RC_PRE((target - origin).norm() > 1e-3);
  RC_ASSERT(RayHitsBox(origin, (target - origin).normalized(), kLow, kHigh));
  // In the opposite direction only when it starts inside.
  const bool starts_inside = (origin.array() >= kLow.array()).all() && (origin.array() <= kHigh.array()).all();
  RC_ASSERT(RayHitsBox(origin, (origin - target).normalized(), kLow, kHigh) == starts_inside);
}

RC_GTEST_PROP(RayHitsBox, AgreesWithFineMarching, ()) {
  const Eigen::Vector3d origin = Anywhere(15.0);
  const Eigen::Vector3d direction = Anywhere(1.0);
  RC_PRE(direction.norm() > 1e-2);
  const Eigen::Vector3d unit = direction.normalized();
  bool deep_inside = false;
  bool near_box = false;
  for (int i = 0; i <= 6000; ++i) {
    const Eigen::Vector3d x = origin + unit * (0.01 * i);
    deep_inside = deep_inside || ((x - kLow).minCoeff() > 0.01 && (kHigh - x).minCoeff() > 0.01);
    near_box = near_box || ((x - kLow).minCoeff() > -0.02 && (kHigh - x).minCoeff() > -0.02);
  }
  const bool meets = RayHitsBox(origin, unit, kLow, kHigh);
  RC_ASSERT(!deep_inside || meets);
  RC_ASSERT(near_box || !meets);
}

TEST(RayHitsBox, AtItsFacesAndBehind) {
  EXPECT_TRUE(RayHitsBox({-5, -2, 0}, {1, 0, 0}, kLow, kHigh)) << "along a face";
  EXPECT_TRUE(RayHitsBox({-1, -2, -3}, {0, 0, -1}, kLow, kHigh)) << "from a corner";
  EXPECT_TRUE(RayHitsBox({0, 0, 0}, {0, 1, 0}, kLow, kHigh)) << "from inside";
  EXPECT_FALSE(RayHitsBox({-5, -2.0001, 0}, {1, 0, 0}, kLow, kHigh)) << "just beside";
  EXPECT_FALSE(RayHitsBox({10, 0, 0}, {1, 0, 0}, kLow, kHigh)) << "behind";
  EXPECT_FALSE(RayHitsBox({std::nan(""), 0, 0}, {1, 0, 0}, kLow, kHigh));
  EXPECT_FALSE(RayHitsBox({0, 0, 0}, {std::nan(""), 0, 0}, kLow, kHigh));
  EXPECT_FALSE(RayHitsBox({0, 0, 0}, {1, 0, 0}, {kNan, -2, -3}, kHigh));
  EXPECT_FALSE(RayHitsBox({0, 0, 0}, {1, 0, 0}, kLow, {kNan, 5, 6}));
  EXPECT_TRUE(RayHitsBox({-5, 0, 0}, {1, 0, 0}, {1, -2, -3}, {1, 5, 6})) << "a flat box";
  EXPECT_TRUE(RayBox({-5, 0, 0}, {1, 0, 0}, {1, -2, -3}, {1, 5, 6}).Empty());
}

// Few, round numbers, so that rays along faces and through corners occur, and flat, inverted and infinite boxes.
Eigen::Vector3d Round(bool may_be_infinite) {
  Eigen::Vector3d x;
  for (int axis = 0; axis < 3; ++axis) {
    const int value = *rc::gen::inRange(-5, 6);
    x[axis] = may_be_infinite && std::abs(value) == 5 ? value * kInfinity : 0.5 * value;
  }
  return x;
}

// The slab method written out separately, as reference.
bool ReferenceSlabTest(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  if (!origin.allFinite() || !direction.allFinite()) return false;
  double t_near = 0.0;
  double t_far = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (!(origin[axis] >= low[axis] && origin[axis] <= high[axis])) return false;
      continue;
    }
    const double to_low = (low[axis] - origin[axis]) / direction[axis];
    const double to_high = (high[axis] - origin[axis]) / direction[axis];
    t_near = std::max(t_near, std::min(to_low, to_high));
    t_far = std::min(t_far, std::max(to_low, to_high));
  }
  return t_near <= t_far;
}

RC_GTEST_PROP(RayHitsBox, AgreesWithAnIndependentSlabTest, ()) {
  for (int i = 0; i < 200; ++i) {
    const bool round = *rc::gen::arbitrary<bool>();
    const Eigen::Vector3d low = Round(true), high = Round(true);
    const Eigen::Vector3d origin = round ? Round(false) : Anywhere(6.0), direction = round ? Round(false) : Anywhere(1.0);
    RC_ASSERT(RayHitsBox(origin, direction, low, high) == ReferenceSlabTest(origin, direction, low, high));
  }
}

// A non-empty interval implies that RayHitsBox is true.
RC_GTEST_PROP(RayBox, HasLengthOnlyWhereTheBoxIsMet, ()) {
  const Eigen::Vector3d origin = Round(false), direction = Round(false), low = Round(false), high = Round(false);
  RC_ASSERT(RayBox(origin, direction, low, high).Empty() || RayHitsBox(origin, direction, low, high));
}

}  // namespace
}  // namespace skyquilt::geo
