#include "worker/planes/plane_fit.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/random.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

RC_GTEST_PROP(PlaneFit, FindsThePlaneOfItsPoints, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  const auto any = [&random] { return Vector3d{random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0)}; };
  const Vector3d normal = (any() + Vector3d(0, 0, 1e-3)).normalized();
  const Vector3d along = normal.unitOrthogonal(), across = normal.cross(along), centre = 1000.0 * any();
  std::vector<Vector3d> points = {centre + along, centre - along, centre + across, centre - across};
  for (int i = 0; i < 4; ++i) points.emplace_back(centre + random.Uniform(-1.0, 1.0) * along + random.Uniform(-1.0, 1.0) * across);
  const std::optional<Plane> plane = FitPlane(points);
  RC_ASSERT(plane.has_value());
  RC_ASSERT(std::abs(plane->normal.dot(normal)) > 1.0 - 1e-9);
  RC_ASSERT(std::abs((plane->point - centre).dot(normal)) < 1e-9);
}

TEST(PlaneFit, SaysNothingWithoutAPlane) {
  const Vector3d x(1, 2, 3);
  EXPECT_FALSE(FitPlane({x, x + Vector3d::UnitX(), x + Vector3d::UnitY()})) << "three points always have a plane";
  EXPECT_FALSE(FitPlane({x, x, x, x, x})) << "equal points";
  EXPECT_FALSE(FitPlane({x, x + Vector3d::UnitX(), x + 2.0 * Vector3d::UnitX(), x + 5.0 * Vector3d::UnitX()})) << "a line";
  EXPECT_FALSE(FitPlane(
      {x + Vector3d::UnitX(), x - Vector3d::UnitX(), x + Vector3d::UnitY(), x - Vector3d::UnitY(), x + Vector3d::UnitZ(), x - Vector3d::UnitZ()}))
      << "a ball";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(FitPlane({x, x + Vector3d::UnitX(), x + Vector3d::UnitY(), Vector3d(nan, 0, 0), x - Vector3d::UnitY()}));
}

TEST(PlaneFit, OnlyNearlyLevelAndVerticalPlanesAreUpright) {
  const Vector3d x(1, 2, 3);
  const std::optional<Plane> roof = UprightPlane({x, Vector3d(0.05, -0.04, -1.0).normalized()});
  ASSERT_TRUE(roof);
  EXPECT_EQ(roof->normal, Vector3d::UnitZ());
  EXPECT_EQ(roof->point, x);
  const std::optional<Plane> wall = UprightPlane({x, Vector3d(0.6, -0.8, 0.1).normalized()});
  ASSERT_TRUE(wall);
  EXPECT_NEAR((wall->normal - Vector3d(0.6, -0.8, 0.0)).norm(), 0.0, 1e-12);
  EXPECT_FALSE(UprightPlane({x, Vector3d(0.5, 0.0, 0.9).normalized()})) << "a pitched roof";
}

TEST(PlaneFit, WallsFollowTheDirectionOfBuildings) {
  const auto wall = [](double yaw_deg, double up) {
    const double yaw = yaw_deg * std::numbers::pi / 180.0;
    return Plane{Vector3d(1, 2, 3), Vector3d(std::cos(yaw), std::sin(yaw), up).normalized()};
  };
  const auto yaw_of = [](const std::optional<Plane>& plane) { return std::atan2(plane->normal.y(), plane->normal.x()) * 180.0 / std::numbers::pi; };
  for (const double side : {0.0, 90.0, 180.0, -90.0}) {
    const std::optional<Plane> turned = UprightPlane(wall(side + 24.0, 0.2), 30.0);
    ASSERT_TRUE(turned);
    EXPECT_EQ(turned->normal.z(), 0.0);
    EXPECT_NEAR(std::remainder(yaw_of(turned) - side - 30.0, 360.0), 0.0, 1e-9);
  }
  EXPECT_NEAR(yaw_of(UprightPlane(wall(15.0, 0.2), 30.0)), 15.0, 1e-9) << "a wall of another direction keeps it";
  EXPECT_EQ(UprightPlane({Vector3d::Zero(), Vector3d(0.0, 0.05, 1.0).normalized()}, 30.0)->normal, Vector3d::UnitZ());
}

}  // namespace
}  // namespace skyquilt::worker
