// Buildings that are rare, large, or badly seen, all the way from points to measures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "buildings/make_buildings.h"
#include "buildings/solids/build_solids.h"
#include "tests/buildings/candidates/made_scene.h"
#include "tests/buildings/sample_buildings.h"
#include "tests/buildings/sample_clouds.h"

namespace skyquilt::buildings {
namespace {

BuildingSet Made(const PointCloud& cloud, const GroundGrid& ground, double gsd_m = 0.19) {
  BuildingsInput input;
  input.cloud = &cloud;
  input.ground = &ground;
  input.georeferenced = true;
  input.gsd_m = gsd_m;
  base::ThreadPool threads(2);
  return MakeBuildings(input, threads);
}

BuildingSet MadeOf(const std::vector<Building>& truth, const CloudPlan& plan = {.noise_m = 0.05, .normal_noise = 0.05}) {
  const Shape& shape = truth.front().shape;
  return Made(MadeCloudOf(truth, plan).cloud, LevelGround(shape.origin, 450.0, shape.ground_z, 3.0), plan.spacing_m / 1.5);
}

HousePlan Flat(double length_m, double width_m, double height_m) {
  HousePlan plan;
  plan.roof = RoofKind::kFlat;
  plan.length_m = length_m;
  plan.width_m = width_m;
  plan.eave_z = plan.ridge_z = plan.ground_z + height_m;
  return plan;
}

// Distances of errors in standard deviations would not tell a wrong shape: these are metres.
void ExpectMeasured(const Building& found, const Building& truth, double tolerance_m) {
  EXPECT_NEAR(found.measures.length_m.value, truth.measures.length_m.value, tolerance_m);
  EXPECT_NEAR(found.measures.width_m.value, truth.measures.width_m.value, tolerance_m);
  EXPECT_NEAR(found.measures.height_m.value, truth.measures.height_m.value, tolerance_m);
  EXPECT_TRUE(CheckSolid(found.lod22).empty());
}

TEST(SpecialBuildings, NoneInAnEmptySurvey) {
  PointCloud cloud;
  cloud.spacing_m = 0.3;
  EXPECT_TRUE(Made(cloud, LevelGround({0, 0}, 20.0, 0.0)).buildings.empty());
}

TEST(SpecialBuildings, ATowerOf150Metres) {
  HousePlan plan = Flat(24.0, 18.0, 150.0);
  plan.yaw_rad = 0.3;
  const Building tower = MadeHouse(plan);
  const BuildingSet set = MadeOf({tower}, {.spacing_m = 0.5, .noise_m = 0.05, .normal_noise = 0.05});
  ASSERT_EQ(set.buildings.size(), 1U);
  ExpectMeasured(set.buildings[0], tower, 0.4);
  EXPECT_TRUE(set.buildings[0].accepted) << set.buildings[0].note;
}

TEST(SpecialBuildings, AHallOf300By200Metres) {
  const Building hall = MadeHouse(Flat(300.0, 200.0, 14.0));
  const BuildingSet set = MadeOf({hall}, {.spacing_m = 0.8, .noise_m = 0.05, .normal_noise = 0.05});
  ASSERT_EQ(set.buildings.size(), 1U);
  ExpectMeasured(set.buildings[0], hall, 1.0);
}

TEST(SpecialBuildings, ACourtyardIsAHole) {
  const Building truth = MadeCourtyard(Flat(26.0, 22.0, 9.0), 7.0);
  const BuildingSet set = MadeOf({truth});
  ASSERT_EQ(set.buildings.size(), 1U);
  const Building& found = set.buildings[0];
  ExpectMeasured(found, truth, 0.3);
  ASSERT_EQ(found.footprint.holes.size(), 1U);
  EXPECT_NEAR(found.measures.footprint_m2.value, truth.measures.footprint_m2.value, 15.0);
  EXPECT_NEAR(Volume(found.lod22), found.measures.volume_m3.value, 0.01 * found.measures.volume_m3.value);
}

// One or two of them are found; both are measured.
TEST(SpecialBuildings, TwoHousesThatShareAWall) {
  HousePlan low, high;
  low.overhang_m = high.overhang_m = 0.0;
  high.origin = low.origin + Eigen::Vector2d(low.length_m, 0.0);
  high.eave_z = 107.5;
  high.ridge_z = 110.5;
  const std::vector<Building> truth = {MadeHouse(low, 1), MadeHouse(high, 2)};
  const BuildingSet set = MadeOf(truth);
  ASSERT_FALSE(set.buildings.empty());
  ASSERT_LE(set.buildings.size(), 2U);
  double volume = 0.0, footprint = 0.0, top = 0.0;
  size_t parts = 0;
  for (const Building& found : set.buildings) {
    EXPECT_TRUE(CheckSolid(found.lod22).empty());
    volume += found.measures.volume_m3.value;
    footprint += found.measures.footprint_m2.value;
    top = std::max(top, found.measures.ridge_m.value);
    parts += found.shape.parts.size();
  }
  EXPECT_EQ(parts, 2U);
  EXPECT_NEAR(top, 110.5, 0.15);
  EXPECT_NEAR(footprint, 2.0 * 96.0, 8.0);
  const double true_volume = truth[0].measures.volume_m3.value + truth[1].measures.volume_m3.value;
  EXPECT_NEAR(volume, true_volume, 0.05 * true_volume);
}

// Its square is a quarter too large, and it says so.
TEST(SpecialBuildings, ARoundTowerIsNotAccepted) {
  MadeCloud made = MadeCloudOf({MadeHouse(Flat(12.0, 12.0, 11.0))}, {.noise_m = 0.04, .normal_noise = 0.05});
  // Everything of the square house that is outside the circle moves to the ground; walls move to the circle.
  const Eigen::Vector2d middle(26.0, 36.0);
  for (size_t i = 0; i < made.surface.size(); ++i) {
    SurfacePoint& point = made.cloud.points[i];
    const Eigen::Vector3d at = made.cloud.At(i);
    const Eigen::Vector2d out = at.head<2>() - middle;
    if (made.surface[i] == MadeSurface::kRoof && out.norm() > 6.0) {
      point.position.z() = 0.0F;
    } else if (made.surface[i] == MadeSurface::kWall) {
      const Eigen::Vector2d on = middle + 6.0 * out.normalized();
      point.position.head<2>() = (on - made.cloud.middle.head<2>()).cast<float>();
      point.normal = Eigen::Vector3d(out.x(), out.y(), 0.0).normalized().cast<float>();
    }
  }
  const BuildingSet set = Made(made.cloud, LevelGround(middle, 40.0, 100.0));
  ASSERT_EQ(set.buildings.size(), 1U);
  const Building& found = set.buildings[0];
  EXPECT_TRUE(found.accepted) << found.note;
  EXPECT_NE(found.note.find("no right angles"), std::string::npos) << found.note;
  EXPECT_NE(found.note.find("follows the roof's outline"), std::string::npos) << found.note;
  EXPECT_NEAR(found.measures.height_m.value, 11.0, 0.2);
  EXPECT_NEAR(found.measures.footprint_m2.value, 36.0 * std::numbers::pi, 3.0 * found.measures.footprint_m2.sigma);
  EXPECT_TRUE(CheckSolid(found.lod22).empty());
}

TEST(SpecialBuildings, OneThatIsCutByTheEdgeOfTheSurveySaysSo) {
  const Building house = MadeHouse(Flat(20.0, 10.0, 6.0));
  MadeCloud made = MadeCloudOf({house}, {.noise_m = 0.04, .normal_noise = 0.05});
  std::erase_if(made.cloud.points, [](const SurfacePoint& point) { return point.position.x() > 14.0F; });
  const BuildingSet set = Made(made.cloud, LevelGround({30.0, 35.0}, 40.0, 100.0));
  ASSERT_EQ(set.buildings.size(), 1U);
  EXPECT_FALSE(set.buildings[0].accepted);
  EXPECT_NE(set.buildings[0].note.find("the survey ends at its outline"), std::string::npos) << set.buildings[0].note;
}

// Points that two photos saw are few and err together over metres.
TEST(SpecialBuildings, ARoofThatTwoPhotosSawClaimsNoPrecision) {
  HousePlan plan;
  plan.overhang_m = 0.0;
  const Building house = MadeHouse(plan);
  MadeCloud well = MadeCloudOf({house}, {.noise_m = 0.05, .normal_noise = 0.05});
  MadeCloud badly = MadeCloudOf({house}, {.spacing_m = 0.45, .noise_m = 0.15, .normal_noise = 0.25, .wall_share = 0.1});
  for (size_t i = 0; i < badly.surface.size(); ++i) {
    if (badly.surface[i] != MadeSurface::kRoof) continue;
    SurfacePoint& point = badly.cloud.points[i];
    point.views = 2;
    point.position.z() += static_cast<float>(0.25 * std::sin(1.1 * static_cast<double>(point.position.x())) *
                                             std::sin(1.3 * static_cast<double>(point.position.y()) + 0.7));
  }
  const GroundGrid ground = LevelGround({26.0, 34.0}, 40.0, 100.0);
  const BuildingSet good = Made(well.cloud, ground), bad = Made(badly.cloud, ground);
  ASSERT_EQ(good.buildings.size(), 1U);
  ASSERT_EQ(bad.buildings.size(), 1U);
  for (const Building& found : bad.buildings) {
    const Measures &m = found.measures, &best = good.buildings[0].measures, &truth = house.measures;
    EXPECT_GT(m.height_m.sigma, best.height_m.sigma);
    EXPECT_GT(m.length_m.sigma, best.length_m.sigma);
    EXPECT_LT(std::abs(m.height_m.value - truth.height_m.value), 4.0 * m.height_m.sigma);
    EXPECT_LT(std::abs(m.length_m.value - truth.length_m.value), 4.0 * m.length_m.sigma);
    EXPECT_LT(std::abs(m.width_m.value - truth.width_m.value), 4.0 * m.width_m.sigma);
    EXPECT_TRUE(CheckSolid(found.lod22).empty());
  }
}

// A cone of 12 m: no shape, and not level. The same form is a crown or the roof of a tower; photos tell.
TEST(SpecialBuildings, WhatHasNoShapeNeedsPhotosThatShowIt) {
  MadeScene scene;
  constexpr double kRadius_m = 6.0;
  scene.Add({[](const Eigen::Vector2d& at) { return at.norm() < kRadius_m ? 3.0 + 1.5 * (kRadius_m - at.norm()) : 0.0; }, kConcrete, {}});
  const PointCloud cloud = scene.Cloud();
  const GroundGrid ground = scene.Ground();
  base::ThreadPool threads(2);
  BuildingsInput input;
  input.cloud = &cloud;
  input.ground = &ground;
  input.georeferenced = true;
  input.gsd_m = MadeScene::kGsd_m;
  EXPECT_TRUE(MakeBuildings(input, threads).buildings.empty());
  input.matched = {{1.0, 2.0, MadeScene::kGround + 8.0}};
  EXPECT_EQ(MakeBuildings(input, threads).buildings.size(), 1U);
}

}  // namespace
}  // namespace skyquilt::buildings
