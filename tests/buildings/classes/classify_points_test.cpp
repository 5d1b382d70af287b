#include "buildings/classes/classify_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "tests/buildings/sample_buildings.h"
#include "tests/buildings/sample_clouds.h"
#include "tests/support/error_of.h"

namespace skyquilt::buildings {
namespace {

constexpr double kGsd_m = 0.1;

struct Scene {
  BuildingSet set;
  MadeCloud made;

  explicit Scene(std::vector<Building> buildings, const CloudPlan& plan = {}) : made(MadeCloudOf(buildings, plan)) {
    set.buildings = std::move(buildings);
    set.gsd_m = kGsd_m;
  }
  std::vector<PointClass> Classes(int n_threads = 2) const {
    base::ThreadPool threads(n_threads);
    const Shape& shape = set.buildings[0].shape;
    return ClassifyPoints(made.cloud, LevelGround(shape.origin, 100.0, shape.ground_z), set, {}, threads);
  }
};

// Share of the points of this surface that have one of these classes.
double Share(const Scene& scene, const std::vector<PointClass>& classes, MadeSurface surface, const std::set<PointClass>& right) {
  double hits = 0.0, all = 0.0;
  for (size_t i = 0; i < classes.size(); ++i) {
    if (scene.made.surface[i] != surface) continue;
    all += 1.0;
    hits += right.contains(classes[i]) ? 1.0 : 0.0;
  }
  return hits / all;
}

void ExpectRight(const Scene& scene, const std::vector<PointClass>& classes) {
  EXPECT_GT(Share(scene, classes, MadeSurface::kRoof, {PointClass::kRoof, PointClass::kEdge, PointClass::kCorner}), 0.97);
  EXPECT_GT(Share(scene, classes, MadeSurface::kWall, {PointClass::kWall, PointClass::kEdge, PointClass::kCorner}), 0.97);
  EXPECT_GT(Share(scene, classes, MadeSurface::kGround, {PointClass::kGround}), 0.97);
}

size_t Count(const std::vector<PointClass>& classes, PointClass wanted) {
  return static_cast<size_t>(std::count(classes.begin(), classes.end(), wanted));
}

class Roofs : public testing::TestWithParam<RoofKind> {};

TEST_P(Roofs, EachSurfaceGetsItsClass) {
  for (const double yaw : {0.0, 0.6}) {
    HousePlan plan;
    plan.roof = GetParam();
    plan.yaw_rad = yaw;
    const Scene scene({MadeHouse(plan)});
    ExpectRight(scene, scene.Classes());
  }
}

INSTANTIATE_TEST_SUITE_P(ClassifyPoints, Roofs, testing::Values(RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip));

TEST(ClassifyPoints, CompoundHousesGetTheirClasses) {
  HousePlan flat;
  flat.roof = RoofKind::kFlat;
  flat.length_m = 16.0;
  flat.width_m = 14.0;
  for (const Building& building : {MadeTHouse({}, {}), MadeLHouse(flat), MadeCourtyard(flat)}) {
    const Scene scene({building});
    ExpectRight(scene, scene.Classes());
  }
}

// Whether points have the class that their distance to the lines of the model says, for a flat house, where the rules are simple.
TEST(ClassifyPoints, EdgesAndCornersEndAtTwoGsd) {
  HousePlan plan;
  plan.roof = RoofKind::kFlat;
  const Scene scene({MadeHouse(plan)}, {.spacing_m = 0.08});
  const std::vector<PointClass> classes = scene.Classes();
  size_t edges = 0, corners = 0, wrong = 0;
  for (size_t i = 0; i < classes.size(); ++i) {
    if (scene.made.surface[i] != MadeSurface::kRoof && scene.made.surface[i] != MadeSurface::kWall) continue;
    const Eigen::Vector3d x = scene.made.cloud.At(i) - Eigen::Vector3d(plan.origin.x(), plan.origin.y(), plan.eave_z);
    const double u = std::min(std::abs(x.x()), std::abs(x.x() - plan.length_m)), v = std::min(std::abs(x.y()), std::abs(x.y() - plan.width_m));
    const double corner = Eigen::Vector3d(u, v, x.z()).norm();
    const double edge = std::min({std::hypot(u, v), std::hypot(u, x.z()), std::hypot(v, x.z())});
    if (std::abs(corner - 2.0 * kGsd_m) < 1e-4 || std::abs(edge - 2.0 * kGsd_m) < 1e-4) continue;
    const bool is_corner = corner < 2.0 * kGsd_m, is_edge = !is_corner && edge < 2.0 * kGsd_m;
    corners += is_corner ? 1 : 0;
    edges += is_edge ? 1 : 0;
    if ((classes[i] == PointClass::kCorner) != is_corner || (classes[i] == PointClass::kEdge) != is_edge) ++wrong;
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(edges, 500U);
  EXPECT_GT(corners, 10U);
}

TEST(ClassifyPoints, AnOverhangIsRoofAndItsBorderIsTheEdge) {
  const Scene scene({MadeHouse({})}, {.spacing_m = 0.1});
  const std::vector<PointClass> classes = scene.Classes();
  double middle = 0.0, middle_roof = 0.0, rim = 0.0, rim_edge = 0.0, above_wall = 0.0, above_wall_roof = 0.0;
  for (size_t i = 0; i < classes.size(); ++i) {
    if (scene.made.surface[i] != MadeSurface::kRoof) continue;
    const Eigen::Vector3d x = scene.made.cloud.At(i) - Eigen::Vector3d(20.0, 30.0, 0.0);
    if (x.x() < 1.0 || x.x() > 11.0) continue;  // without the gables
    if (x.y() > -0.18 && x.y() < -0.02) middle_roof += classes[i] == PointClass::kRoof, middle += 1.0;
    if (x.y() < -0.25) rim_edge += classes[i] == PointClass::kEdge, rim += 1.0;
    if (x.y() > 0.02 && x.y() < 0.2) above_wall_roof += classes[i] == PointClass::kRoof, above_wall += 1.0;
  }
  ASSERT_GT(middle, 50.0);
  ASSERT_GT(rim, 50.0);
  EXPECT_GT(middle_roof / middle, 0.97);
  EXPECT_GT(rim_edge / rim, 0.97);
  // The edge of the model at the wall is inside the roof.
  EXPECT_GT(above_wall_roof / above_wall, 0.97);
}

TEST(ClassifyPoints, TheRidgeIsAnEdgeAndItsEndsAreCorners) {
  const Building house = MadeHouse({});
  Scene scene({house}, {.spacing_m = 0.1});
  const std::vector<PointClass> classes = scene.Classes();
  size_t near_end = 0, corner = 0, ridge = 0, edge = 0;
  for (size_t i = 0; i < classes.size(); ++i) {
    if (scene.made.surface[i] != MadeSurface::kRoof) continue;
    const Eigen::Vector3d x = scene.made.cloud.At(i) - Eigen::Vector3d(20.0, 34.0, 108.0);
    if (std::hypot(x.y(), x.z()) > 0.15) continue;
    const double to_end = std::min(std::abs(x.x() + 0.4), std::abs(x.x() - 12.4));
    if (to_end < 0.1) corner += classes[i] == PointClass::kCorner, ++near_end;
    if (to_end > 0.3) edge += classes[i] == PointClass::kEdge, ++ridge;
  }
  ASSERT_GT(near_end, 3U);
  ASSERT_GT(ridge, 100U);
  EXPECT_EQ(corner, near_end);
  EXPECT_EQ(edge, ridge);
}

TEST(ClassifyPoints, EdgesOfCoplanarFacesDoNotCount) {
  // The same flat house with its roof in two faces.
  HousePlan plan;
  plan.roof = RoofKind::kFlat;
  Building house = MadeHouse(plan);
  const Scene whole({house}, {.spacing_m = 0.15});
  Solid& solid = house.lod22;
  const auto roof = std::find_if(solid.face.begin(), solid.face.end(), [](const Face& face) { return face.kind == FaceKind::kRoof; });
  ASSERT_EQ(roof->outer.size(), 4U);
  const Face second{FaceKind::kRoof, {roof->outer[0], roof->outer[2], roof->outer[3]}, {}};
  roof->outer.pop_back();
  solid.face.push_back(second);
  const Scene split({house}, {.spacing_m = 0.15});
  EXPECT_EQ(whole.Classes(), split.Classes());
}

TEST(ClassifyPoints, TreesAreVegetationAndLeaveTheHouseAlone) {
  Scene scene({MadeHouse({})});
  const std::vector<PointClass> alone = scene.Classes();
  AddTree(&scene.made, {18.2, 26.5, 105.0}, 1.8);            // 0.2 m beside the eaves' corner
  AddTree(&scene.made, {40.0, 34.0, 104.0}, 2.0, false, 5);  // bare
  const std::vector<PointClass> classes = scene.Classes();
  EXPECT_GT(Share(scene, classes, MadeSurface::kTree, {PointClass::kVegetation}), 0.95);
  EXPECT_TRUE(std::equal(alone.begin(), alone.end(), classes.begin()));
  EXPECT_EQ(Count(alone, PointClass::kVegetation), 0U);
}

TEST(ClassifyPoints, GreenAloneMakesHighPointsVegetationAndLowOnesNot) {
  Scene scene({MadeHouse({})});
  const auto add = [&](const Eigen::Vector3d& x, const std::array<uint8_t, 3>& rgb) {
    SurfacePoint point{(x - scene.made.cloud.middle).cast<float>(), Eigen::Vector3f::UnitZ(), rgb, 3, 0};
    scene.made.cloud.points.push_back(point);
  };
  add({50.0, 50.0, 102.0}, {70, 110, 50});  // a lone green point
  add({60.0, 50.0, 102.0}, {90, 90, 90});   // the same in grey
  add({70.0, 50.0, 100.7}, {70, 110, 50});  // above the ground, below half of the least height
  add({75.0, 50.0, 100.2}, {70, 110, 50});  // grass
  const std::vector<PointClass> classes = scene.Classes();
  const std::vector<PointClass> last(classes.end() - 4, classes.end());
  EXPECT_EQ(last, (std::vector<PointClass>{PointClass::kVegetation, PointClass::kOther, PointClass::kOther, PointClass::kGround}));
}

TEST(ClassifyPoints, WhatStandsOnARoofIsRoofOrWall) {
  HousePlan plan;
  plan.roof = RoofKind::kFlat;
  Scene scene({MadeHouse(plan)});
  const size_t n = scene.made.cloud.points.size();
  const auto add = [&](double z, const Eigen::Vector3f& normal) {
    SurfacePoint point{(Eigen::Vector3d(26.0, 34.0, z) - scene.made.cloud.middle).cast<float>(), normal, {128, 128, 128}, 3, 0};
    scene.made.cloud.points.push_back(point);
  };
  add(106.5, Eigen::Vector3f::UnitZ());   // a box on the deck
  add(106.0, -Eigen::Vector3f::UnitY());  // its side
  add(100.1, Eigen::Vector3f::UnitZ());   // at the height of the ground below the house
  const std::vector<PointClass> classes = scene.Classes();
  EXPECT_EQ(classes[n], PointClass::kRoof);
  EXPECT_EQ(classes[n + 1], PointClass::kWall);
  EXPECT_NE(classes[n + 2], PointClass::kGround);
}

TEST(ClassifyPoints, GroundOfACourtyardIsGround) {
  HousePlan plan;
  plan.length_m = 16.0;
  plan.width_m = 14.0;
  const Scene scene({MadeCourtyard(plan)});
  const std::vector<PointClass> classes = scene.Classes();
  size_t inside = 0;
  for (size_t i = 0; i < classes.size(); ++i) {
    const Eigen::Vector3d x = scene.made.cloud.At(i);
    if (scene.made.surface[i] != MadeSurface::kGround || x.x() < 23.0 || x.x() > 33.0 || x.y() < 33.0 || x.y() > 41.0) continue;
    EXPECT_EQ(classes[i], PointClass::kGround);
    ++inside;
  }
  EXPECT_GT(inside, 500U);
}

TEST(ClassifyPoints, WallsGoOnDownASlope) {
  HousePlan plan;
  plan.roof = RoofKind::kFlat;
  Scene scene({MadeHouse(plan)});
  const size_t n = scene.made.cloud.points.size();
  SurfacePoint point{(Eigen::Vector3d(26.0, 30.0, 98.5) - scene.made.cloud.middle).cast<float>(), -Eigen::Vector3f::UnitY(), {128, 128, 128}, 3, 0};
  scene.made.cloud.points.push_back(point);
  base::ThreadPool threads(1);
  EXPECT_EQ(ClassifyPoints(scene.made.cloud, LevelGround({20.0, 30.0}, 100.0, 97.0), scene.set, {}, threads)[n], PointClass::kWall);
}

TEST(ClassifyPoints, NoiseLeavesMostClassesRight) {
  const Scene scene({MadeHouse({})}, {.noise_m = 0.1, .normal_noise = 0.15});
  const std::vector<PointClass> classes = scene.Classes();
  EXPECT_GT(Share(scene, classes, MadeSurface::kRoof, {PointClass::kRoof, PointClass::kEdge, PointClass::kCorner}), 0.95);
  EXPECT_GT(Share(scene, classes, MadeSurface::kWall, {PointClass::kWall, PointClass::kEdge, PointClass::kCorner}), 0.93);
  EXPECT_GT(Share(scene, classes, MadeSurface::kGround, {PointClass::kGround}), 0.97);
}

TEST(ClassifyPoints, TheSameForAnyNumberOfThreads) {
  std::vector<Building> buildings;
  for (int i = 0; i < 4; ++i) {
    HousePlan plan;
    plan.roof = i % 2 == 0 ? RoofKind::kHip : RoofKind::kGable;
    plan.origin += Eigen::Vector2d(18.0 * i, 3.0 * i);
    plan.yaw_rad = 0.2 * i;
    buildings.push_back(MadeHouse(plan, i + 1));
  }
  Scene scene(buildings, {.noise_m = 0.1, .normal_noise = 0.3});
  for (uint64_t i = 0; i < 5; ++i) AddTree(&scene.made, {20.0 + 15.0 * static_cast<double>(i), 25.0, 103.0}, 2.0, i % 2 == 0, i + 9);
  const std::vector<PointClass> one = scene.Classes(1);
  EXPECT_EQ(one, scene.Classes(3));
  EXPECT_EQ(one, scene.Classes(8));
  for (const Building& building : buildings) EXPECT_GT(building.id, 0);
}

TEST(ClassifyPoints, WithoutBuildingsThereIsGroundAndVegetation) {
  Scene scene({MadeHouse({})});
  scene.set.buildings.resize(1);
  AddTree(&scene.made, {40.0, 34.0, 104.0}, 2.0);
  base::ThreadPool threads(2);
  BuildingSet none;
  const auto classes = ClassifyPoints(scene.made.cloud, LevelGround({20.0, 30.0}, 100.0, 100.0), none, {}, threads);
  EXPECT_GT(Count(classes, PointClass::kGround), 1000U);
  EXPECT_GT(Count(classes, PointClass::kVegetation), 300U);
  for (const PointClass building : {PointClass::kRoof, PointClass::kWall, PointClass::kEdge, PointClass::kCorner})
    EXPECT_EQ(Count(classes, building), 0U);
  EXPECT_TRUE(ClassifyPoints({}, LevelGround({0.0, 0.0}, 1.0, 0.0), none, {}, threads).empty());
}

TEST(ClassifyPoints, UnknownGroundAndDamagedPointsAreOther) {
  Scene scene({MadeHouse({})});
  for (SurfacePoint& point : scene.made.cloud.points) point.position += Eigen::Vector3f(500.0F, 0.0F, 0.0F);
  scene.made.cloud.points[0].position.x() = std::numeric_limits<float>::quiet_NaN();
  const std::vector<PointClass> classes = scene.Classes();
  EXPECT_EQ(Count(classes, PointClass::kOther), classes.size());
}

TEST(ClassifyPoints, StopsWhenAsked) {
  const Scene scene({MadeHouse({})});
  ExpectStopsWhenAsked([&] { scene.Classes(); });
}

TEST(PointClass, NamesAndCodesAreDistinct) {
  std::set<std::string> names;
  std::set<int> codes;
  for (int i = 0; i < kPointClasses; ++i) {
    names.insert(NameOf(static_cast<PointClass>(i)));
    codes.insert(LasCode(static_cast<PointClass>(i)));
  }
  EXPECT_EQ(names.size(), static_cast<size_t>(kPointClasses));
  EXPECT_EQ(codes, (std::set<int>{1, 2, 5, 6, 64, 65, 66}));
  EXPECT_STREQ(NameOf(PointClass::kVegetation), "vegetation");
  EXPECT_EQ(LasCode(PointClass::kGround), 2);
}

}  // namespace
}  // namespace skyquilt::buildings
