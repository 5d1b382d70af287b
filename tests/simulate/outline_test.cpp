#include "simulate/outline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "simulate/compound.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Building House(double length_m, double width_m, RoofKind roof = RoofKind::kGable) {
  Building house;
  house.roof = roof;
  house.length_m = length_m;
  house.width_m = width_m;
  if (roof == RoofKind::kFlat) house.ridge_height_m = house.eave_height_m;
  return house;
}

Outline Only(std::vector<Building>& parts) {
  NumberOutlines(parts);
  const std::vector<Outline> outlines = FindOutlines(parts);
  EXPECT_EQ(outlines.size(), 1U);
  return outlines.at(0);
}

TEST(Outline, OfOneBuildingIsItsRectangle) {
  std::vector<Building> one = {House(10.0, 6.0)};
  one[0].centre = {7.0, -3.0};
  one[0].yaw_deg = 30.0;
  const Outline outline = Only(one);
  EXPECT_EQ(outline.centre, one[0].centre);
  EXPECT_EQ(outline.yaw_deg, 30.0);
  EXPECT_EQ(outline.length_m, 10.0);
  EXPECT_EQ(outline.width_m, 6.0);
  EXPECT_NEAR(outline.area_m2, 60.0, 1e-9);
  ASSERT_EQ(outline.walls.size(), 4U);
  for (const Vector2d& corner : outline.walls) EXPECT_NEAR((corner - one[0].centre).norm(), std::hypot(5.0, 3.0), 1e-9);
  EXPECT_NEAR(SignedArea(outline.walls), 60.0, 1e-9);
  EXPECT_NEAR(SignedArea(outline.roof), 10.8 * 6.8, 1e-9);
}

TEST(Outline, OfAnLHasSixCornersAndTheOverhangOfBothRoofs) {
  std::vector<Building> parts = WithWing(House(9.0, 7.0), {2.25, 4.5, 5.0, 5.0}, BuildingShape::kL);
  MoveParts({Vector2d::Zero(), 77.0}, {20.0, 30.0}, parts);
  const Outline outline = Only(parts);
  EXPECT_EQ(outline.walls.size(), 6U);
  EXPECT_NEAR(outline.area_m2, 63.0 + 22.5, 1e-6);
  EXPECT_EQ(outline.largest, 0U);
  EXPECT_NEAR((outline.centre - Vector2d(20.0, 30.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(outline.length_m, 12.0, 1e-9);
  EXPECT_NEAR(outline.width_m, 9.0, 1e-9);
  EXPECT_NEAR(std::abs(std::remainder(outline.yaw_deg - 77.0, 180.0)), 90.0, 1e-9);
  // 0.4 m around everything, where the wing's overhang at the main roof is inside that of the main roof.
  EXPECT_EQ(outline.roof.size(), 6U);
  EXPECT_NEAR(SignedArea(outline.roof), 9.8 * 7.8 + 5.3 * 5.0, 1e-6);
}

TEST(Outline, OfACourtyardHasAHoleAndNoOverhang) {
  std::vector<Building> parts = Courtyard(House(40.0, 9.0, RoofKind::kFlat), {38.0, 30.0}, 9.0, {5.0, 5.0, 5.0, 8.0});
  MoveParts({Vector2d::Zero(), -20.0}, {-5.0, 4.0}, parts);
  const Outline outline = Only(parts);
  ASSERT_EQ(outline.holes.size(), 1U);
  EXPECT_EQ(outline.walls.size(), 4U);
  EXPECT_NEAR(SignedArea(outline.holes[0]), -20.0 * 12.0, 1e-6);
  EXPECT_NEAR(outline.area_m2, 38.0 * 30.0 - 20.0 * 12.0, 1e-6);
  EXPECT_NEAR(SignedArea(outline.roof), 38.0 * 30.0, 1e-6);
}

TEST(Outline, OfARowIsOneAndOfASetbackThePodium) {
  std::vector<Building> row = Row({House(8.0, 7.0), House(9.0, 7.0), House(8.5, 7.6)});
  const Outline of_row = Only(row);
  EXPECT_EQ(of_row.n_parts, 3U);
  EXPECT_EQ(of_row.walls.size(), 6U);
  EXPECT_NEAR(of_row.area_m2, 17.0 * 7.0 + 8.5 * 7.6, 1e-6);
  EXPECT_EQ(of_row.largest, 2U);
  std::vector<Building> setback = WithSetback(House(24.0, 18.0, RoofKind::kFlat), {9.0, 13.0}, {2.0, 0.0}, 30.0);
  const Outline of_setback = Only(setback);
  EXPECT_EQ(of_setback.walls.size(), 4U);
  EXPECT_NEAR(of_setback.area_m2, 24.0 * 18.0, 1e-6);
  EXPECT_EQ(of_setback.largest, 0U);
}

TEST(Outline, NumbersFollowTheList) {
  std::vector<Building> buildings = {House(9.0, 7.0)};
  for (const Building& part : Row({House(8.0, 7.0), House(9.0, 7.0)})) buildings.push_back(part);
  buildings.push_back(House(5.0, 4.0));
  NumberOutlines(buildings);
  EXPECT_EQ(buildings[0].outline, 0U);
  EXPECT_EQ(buildings[1].outline, 1U);
  EXPECT_EQ(buildings[2].outline, 1U);
  EXPECT_EQ(buildings[3].outline, 2U);
  const std::vector<Outline> outlines = FindOutlines(buildings);
  ASSERT_EQ(outlines.size(), 3U);
  EXPECT_EQ(outlines[1].first, 1U);
  EXPECT_EQ(outlines[2].first, 3U);
}

TEST(RoofPlanes, GoThroughEavesAndRidge) {
  base::Random random(8);
  for (const RoofKind roof : {RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip}) {
    Building house = House(12.0, 8.0, roof);
    house.centre = {random.Uniform(-40.0, 40.0), random.Uniform(-40.0, 40.0)};
    house.yaw_deg = random.Uniform(0.0, 360.0);
    house.ground_z_m = 3.0;
    const Vector2d u = house.Axis(), v(-u.y(), u.x());
    const std::vector<RoofPlane3d> planes = RoofPlanes(house);
    EXPECT_EQ(planes.size(), roof == RoofKind::kFlat ? 1U : roof == RoofKind::kGable ? 2U : 4U);
    for (const RoofPlane3d& plane : planes) {
      EXPECT_NEAR(plane.normal.norm(), 1.0, 1e-12);
      EXPECT_GT(plane.normal.z(), 0.5);
    }
    EXPECT_NEAR(RoofHeight(house, house.centre), 3.0 + house.ridge_height_m, 1e-9);
    for (const double side : {-4.0, 4.0}) EXPECT_NEAR(RoofHeight(house, house.centre + side * v), 3.0 + house.eave_height_m, 1e-9);
    const double at_end = roof == RoofKind::kGable ? house.ridge_height_m : house.eave_height_m;
    for (const double side : {-6.0, 6.0}) EXPECT_NEAR(RoofHeight(house, house.centre + side * u), 3.0 + at_end, 1e-9);
  }
}

}  // namespace
}  // namespace skyquilt::simulate
