#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "buildings/geometry/polygon.h"
#include "tests/buildings/geometry/made_polygons.h"

namespace skyquilt::buildings {
namespace {

using Points = std::vector<Eigen::Vector2d>;

TEST(LeastAreaRectangle, FindsATurnedRectangle) {
  const Rectangle made{{100.0, -50.0}, {0.8, 0.6}, {9.0, 4.0}};
  Points points = made.Outline().outer;
  points.push_back(made.centre);
  points.push_back(0.5 * (points[0] + points[1]));
  const Rectangle found = LeastAreaRectangle(points);
  EXPECT_LT((found.centre - made.centre).norm(), 1e-9);
  EXPECT_NEAR(std::abs(found.axis.dot(made.axis)), 1.0, 1e-12);
  EXPECT_LT((found.half - made.half).norm(), 1e-9);
}

TEST(LeastAreaRectangle, OfFewPoints) {
  const Rectangle one = LeastAreaRectangle(Points{{3.0, 4.0}});
  EXPECT_EQ(one.centre, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(one.half, Eigen::Vector2d::Zero());
  const Rectangle same = LeastAreaRectangle(Points{{3.0, 4.0}, {3.0, 4.0}, {3.0, 4.0}});
  EXPECT_EQ(same.half, Eigen::Vector2d::Zero());
  const Rectangle line = LeastAreaRectangle(Points{{0.0, 0.0}, {6.0, 8.0}, {3.0, 4.0}});
  EXPECT_NEAR(line.half.x(), 5.0, 1e-12);
  EXPECT_NEAR(line.half.y(), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(line.axis.dot(Eigen::Vector2d(0.6, 0.8))), 1.0, 1e-12);
}

TEST(RectangleAlong, KeepsTheAxisThoughItIsTheShorterSide) {
  const Rectangle found = RectangleAlong(Points{{0.0, 0.0}, {1.0, 0.0}, {1.0, 5.0}}, {2.0, 0.0});
  EXPECT_EQ(found.axis, Eigen::Vector2d::UnitX());
  EXPECT_LT((found.half - Eigen::Vector2d(0.5, 2.5)).norm(), 1e-12);
  EXPECT_LT((found.centre - Eigen::Vector2d(0.5, 2.5)).norm(), 1e-12);
}

RC_GTEST_PROP(LeastAreaRectangle, HoldsAllPointsAndIsLeastOverAllDirections, (uint32_t seed)) {
  base::Random random(seed);
  Points points;
  const uint32_t n = 3 + random.Below(40);
  for (uint32_t i = 0; i < n; ++i) points.push_back({random.Uniform(0.0, 8.0), random.Uniform(0.0, 3.0) + random.Uniform(0.0, 3.0)});
  const Rectangle found = LeastAreaRectangle(points);
  RC_ASSERT(found.half.x() >= found.half.y());
  RC_ASSERT(std::abs(found.axis.norm() - 1.0) < 1e-12);
  const Eigen::Vector2d across(-found.axis.y(), found.axis.x());
  for (const Eigen::Vector2d& p : points) {
    RC_ASSERT(std::abs((p - found.centre).dot(found.axis)) <= found.half.x() + 1e-9);
    RC_ASSERT(std::abs((p - found.centre).dot(across)) <= found.half.y() + 1e-9);
  }
  for (int i = 0; i < 360; ++i) {
    const double angle = 0.25 * i * std::numbers::pi / 180.0;
    RC_ASSERT(RectangleAlong(points, {std::cos(angle), std::sin(angle)}).half.prod() >= found.half.prod() - 1e-9);
  }
}

}  // namespace
}  // namespace skyquilt::buildings
