#include "buildings/candidates/find_candidates.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "tests/buildings/candidates/made_scene.h"

namespace skyquilt::buildings {
namespace {

std::vector<Candidate> Find(const MadeScene& scene, const PointCloud& cloud, int n_threads = 2) {
  base::ThreadPool threads(n_threads);
  return FindCandidates(cloud, scene.Ground(), {}, MadeScene::kGsd_m, threads);
}

std::vector<Candidate> Find(const MadeScene& scene) {
  return Find(scene, scene.Cloud());
}

double Overlap(const Candidate& candidate, const Polygon& truth) {
  return IntersectionOverUnion(std::vector<Polygon>{candidate.outline}, std::vector<Polygon>{truth});
}

bool Same(const Candidate& a, const Candidate& b) {
  const bool same_planes = std::equal(a.planes.begin(), a.planes.end(), b.planes.begin(), b.planes.end(),
                                      [](const RoofPlane& x, const RoofPlane& y) { return x.points == y.points && x.normal == y.normal; });
  return same_planes && a.roof == b.roof && a.wall == b.wall && a.ground == b.ground && a.outline.outer == b.outline.outer &&
         a.outline.holes == b.outline.holes;
}

TEST(FindCandidates, NothingInEmptyClouds) {
  const MadeScene scene;
  PointCloud empty;
  empty.spacing_m = MadeScene::kSpacing_m;
  EXPECT_TRUE(Find(scene, empty).empty());
}

TEST(FindCandidates, NothingOnFlatFields) {
  EXPECT_TRUE(Find(MadeScene(20.0, kLawn)).empty());
  EXPECT_TRUE(Find(MadeScene(20.0, kGreyGround)).empty());
}

TEST(FindCandidates, NothingInForests) {
  MadeScene scene(20.0, kLawn);
  for (int i = 0; i < 49; ++i) scene.AddTree({-17.0 + 5.5 * (i % 7), -17.0 + 5.5 * (i / 7)}, 2.5 + 0.3 * (i % 4), 6.0 + 0.7 * (i % 5));
  EXPECT_TRUE(Find(scene).empty());
}

TEST(FindCandidates, NothingAtCarsAndHedges) {
  MadeScene scene;
  scene.AddBox(MadeScene::At(0, 0, 4.6, 1.8), 1.5);
  scene.AddBox(MadeScene::At(8, 5, 8.0, 2.2, 30), 1.9);             // a small truck
  scene.AddBox(MadeScene::At(-8, 5, 18.0, 1.2, 70), 2.4, kLeaves);  // a hedge
  scene.AddBox(MadeScene::At(5, -10, 20.0, 0.6, 10), 2.6);          // a garden wall
  EXPECT_TRUE(Find(scene).empty());
}

RC_GTEST_PROP(FindCandidates, FindsAHouseBesideATree, ()) {
  const double yaw_deg = *rc::gen::inRange(0, 90), pitch_deg = *rc::gen::inRange(20, 61);
  const auto seed = *rc::gen::inRange<uint64_t>(1, 100000);
  MadeScene scene(11.0, kLawn);
  const Rectangle roof = MadeScene::At(-1, 1, 9.0, 7.0, yaw_deg);
  scene.AddGable(roof, 4.0, pitch_deg);
  // Its crown touches the roof at the height of the eave.
  const Eigen::Vector2d across(-roof.axis.y(), roof.axis.x());
  scene.AddTree(roof.centre + (roof.half.y() + 1.8) * across, 2.0, 5.0);
  const PointCloud cloud = scene.Cloud(0.04, seed);
  const std::vector<Candidate> found = Find(scene, cloud);
  RC_ASSERT(found.size() == 1U);
  const Candidate& house = found.front();
  RC_ASSERT(Overlap(house, roof.Outline()) > 0.87);
  RC_ASSERT(house.outline.holes.empty());
  RC_ASSERT(house.planes.size() >= 2U);
  // Few points of the crown, and only those beside the edge.
  const auto green = std::count_if(house.roof.begin(), house.roof.end(), [&](uint32_t i) { return cloud.points[i].rgb == kLeaves; });
  RC_ASSERT(static_cast<double>(green) < 0.03 * static_cast<double>(house.roof.size()));
  const Eigen::Vector3d up(0, 0, 1);
  for (size_t p = 0; p < 2; ++p) {
    RC_ASSERT(std::abs(house.planes[p].normal.dot(up) - std::cos(pitch_deg * std::numbers::pi / 180.0)) < 0.05);
    RC_ASSERT(house.planes[p].area_m2 > 0.75 * 9.0 * 3.5);
  }
}

TEST(FindCandidates, GathersRoofWallsAndGround) {
  MadeScene scene;
  const Rectangle walls = MadeScene::At(2, -3, 12.0, 8.0, 20);
  scene.AddBox(walls, 6.0);
  const PointCloud cloud = scene.Cloud();
  const std::vector<Candidate> found = Find(scene, cloud);
  ASSERT_EQ(found.size(), 1U);
  const Candidate& house = found.front();
  EXPECT_FALSE(house.given);
  EXPECT_GT(Overlap(house, walls.Outline()), 0.93);
  const auto expected = [](double area_m2) { return area_m2 / (MadeScene::kSpacing_m * MadeScene::kSpacing_m); };
  EXPECT_NEAR(static_cast<double>(house.roof.size()), expected(96.0), 0.08 * expected(96.0));
  EXPECT_NEAR(static_cast<double>(house.wall.size()), expected(240.0), 0.08 * expected(240.0));
  EXPECT_GT(static_cast<double>(house.ground.size()), expected(100.0));
  EXPECT_TRUE(std::is_sorted(house.roof.begin(), house.roof.end()));
  for (const uint32_t i : house.roof) EXPECT_NEAR(cloud.At(i).z(), 46.0, 0.3);
  for (const uint32_t i : house.wall) EXPECT_LT(std::abs(cloud.points[i].normal.z()), 0.35);
  for (const uint32_t i : house.ground) {
    EXPECT_NEAR(cloud.At(i).z(), 40.0, 0.3);
    const double distance = DistanceToBorder(walls.Outline(), cloud.At(i).head<2>());
    EXPECT_GT(distance, 0.1);  // corners of the outline are rounded
    EXPECT_LT(distance, 3.3);
  }
}

TEST(FindCandidates, SmallestAreaDecides) {
  for (const double side : {3.0, 3.47}) {  // sheds of 9 and 12 m2
    MadeScene scene(10.0, kLawn);
    scene.AddBox(MadeScene::At(0, 0, side, side, 25), 2.6);
    EXPECT_EQ(Find(scene).size(), side > 3.2 ? 1U : 0U) << side;
  }
}

TEST(FindCandidates, CourtyardsAreHolesAndBoxesAreNot) {
  MadeScene scene;
  const Polygon outer = MadeScene::At(0, 0, 24.0, 20.0).Outline(), yard = MadeScene::At(2, 0, 10.0, 8.0).Outline();
  Polygon house = Difference(outer, std::vector<Polygon>{yard}).front();
  scene.Add({[=](const Eigen::Vector2d& at) { return Contains(house, at) ? 7.0 : 0.0; }, kConcrete, {house}});
  scene.AddBox(MadeScene::At(-7, 5, 3.0, 2.5), 9.5);  // a lift house
  const std::vector<Candidate> found = Find(scene);
  ASSERT_EQ(found.size(), 1U);
  ASSERT_EQ(found.front().outline.holes.size(), 1U);
  EXPECT_GT(Overlap(found.front(), house), 0.9);
  // The sides of the lift house are no walls of the building.
  const PointCloud cloud = scene.Cloud();
  for (const uint32_t i : found.front().wall) EXPECT_LT(cloud.At(i).z(), 47.3);
}

TEST(FindCandidates, ParapetsAndRoughRoofsBelongToTheOutline) {
  MadeScene scene;
  const Rectangle walls = MadeScene::At(0, 0, 14.0, 12.0, 10);
  Rectangle inside = walls;
  inside.half -= Eigen::Vector2d(0.4, 0.4);
  const Polygon outer = walls.Outline(), inner = inside.Outline();
  scene.Add({[=](const Eigen::Vector2d& at) { return !Contains(outer, at) ? 0.0 : Contains(inner, at) ? 8.0 : 8.9; }, kConcrete, {outer}});
  // Pipes and boxes in a corner.
  scene.Add({[=](const Eigen::Vector2d& at) {
               const bool here = Contains(inner, at) && (at - walls.centre).dot(walls.axis) > 4.0 && at.y() > 2.0;
               return here ? 8.2 + 0.9 * std::abs(std::sin(2.0 * at.x()) * std::sin(2.4 * at.y())) : 0.0;
             },
             kConcrete,
             {}});
  const std::vector<Candidate> found = Find(scene);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(Overlap(found.front(), outer), 0.9);
  EXPECT_TRUE(found.front().outline.holes.empty());
}

TEST(FindCandidates, NarrowGapsSeparateHouses) {
  MadeScene scene;
  const Rectangle a = MadeScene::At(-4.4, 0, 8.0, 10.0), b = MadeScene::At(4.4, 0, 8.0, 10.0);  // 0.8 m between them
  scene.AddBox(a, 5.0);
  scene.AddBox(b, 5.2);
  const std::vector<Candidate> found = Find(scene);
  ASSERT_EQ(found.size(), 2U);
  std::set<uint32_t> walls;
  for (const Candidate& house : found) {
    EXPECT_GT(std::max(Overlap(house, a.Outline()), Overlap(house, b.Outline())), 0.88);
    for (const uint32_t i : house.wall) EXPECT_TRUE(walls.insert(i).second) << "a wall point of two houses";
  }
}

TEST(FindCandidates, JoinedHousesOfDifferentHeightAreOne) {
  MadeScene scene;
  scene.AddBox(MadeScene::At(-4, 0, 8.0, 10.0), 5.0);
  scene.AddBox(MadeScene::At(4, 0, 8.0, 10.0), 8.0);
  const std::vector<Candidate> found = Find(scene);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(Overlap(found.front(), MadeScene::At(0, 0, 16.0, 10.0).Outline()), 0.92);
  EXPECT_GE(found.front().planes.size(), 2U);
  // The wall between their roofs is in the middle of the outline.
  const PointCloud cloud = scene.Cloud();
  const auto inner = std::count_if(found.front().wall.begin(), found.front().wall.end(), [&](uint32_t i) {
    return std::abs(cloud.At(i).x()) < 0.3 && std::abs(cloud.At(i).y()) < 3.0 && cloud.At(i).z() > 45.3;
  });
  EXPECT_GT(inner, 200);
}

TEST(FindCandidates, GreenRoofsAreRoofsWhenLargeAndEven) {
  MadeScene scene;
  scene.AddBox(MadeScene::At(0, 0, 12.0, 9.0), 5.0, kLawn);
  const PointCloud even = scene.Cloud(0.02);
  EXPECT_EQ(Find(scene, even).size(), 1U);
  MadeScene small;
  small.AddBox(MadeScene::At(0, 0, 4.5, 4.0), 3.0, kLeaves);
  EXPECT_TRUE(Find(small, small.Cloud(0.02)).empty());
}

// At the edge of a survey the field invents sheets that float over the ground or rise from it.
TEST(FindCandidates, SheetsWithoutEdgesAreNoBuildings) {
  MadeScene scene;
  scene.Add({[](const Eigen::Vector2d& at) { return std::clamp(0.35 * (at.x() - 2.0), 0.0, 4.5); }, kGreyGround, {}});
  EXPECT_TRUE(Find(scene).empty());
}

TEST(FindCandidates, NoGroundNoBuildings) {
  MadeScene scene;
  scene.AddBox(MadeScene::At(0, 0, 10.0, 8.0), 5.0);
  base::ThreadPool threads(1);
  const GroundGrid nowhere({500, 500}, 1.0, 2, 2, {40, 40, 40, 40});
  EXPECT_TRUE(FindCandidates(scene.Cloud(), nowhere, {}, MadeScene::kGsd_m, threads).empty());
}

TEST(FindCandidates, SameForAnyNumberOfThreads) {
  MadeScene scene(25.0, kLawn);
  scene.AddGable(MadeScene::At(-12, -10, 12, 8, 15), 4.0, 35);
  scene.AddBox(MadeScene::At(10, -12, 14, 9, 15), 6.0);
  scene.AddGable(MadeScene::At(-10, 12, 9, 7, 80), 3.5, 45);
  scene.AddTree({-5, 12}, 2.5, 6.0);
  scene.AddBox(MadeScene::At(12, 10, 6, 5, 40), 3.0);
  const PointCloud cloud = scene.Cloud(0.06);
  const std::vector<Candidate> one = Find(scene, cloud, 1), four = Find(scene, cloud, 4);
  ASSERT_EQ(one.size(), 4U);
  EXPECT_TRUE(std::equal(one.begin(), one.end(), four.begin(), four.end(), Same));
  EXPECT_TRUE(std::is_sorted(one.begin(), one.end(), [](const Candidate& a, const Candidate& b) { return Area(a.outline) > Area(b.outline); }));
}

std::vector<Candidate> In(const std::vector<GivenOutline>& outlines, const MadeScene& scene, const PointCloud& cloud) {
  base::ThreadPool threads(2);
  return CandidatesIn(outlines, cloud, scene.Ground(), {}, MadeScene::kGsd_m, threads);
}

TEST(CandidatesIn, OneForEachOutlineInTheirOrder) {
  MadeScene scene;
  const Rectangle shed = MadeScene::At(-8, -8, 3.0, 2.5), house = MadeScene::At(5, 5, 12.0, 8.0, 30);
  scene.AddBox(shed, 2.6);
  scene.AddGable(house, 4.0, 40);
  const PointCloud cloud = scene.Cloud();
  const std::vector<GivenOutline> outlines = {{shed.Outline(), "shed"},
                                              {MadeScene::At(-10, 10, 6.0, 6.0).Outline(), "field"},
                                              {house.Outline(), ""},
                                              {MadeScene::At(900, 0, 5, 5).Outline(), "far"}};
  const std::vector<Candidate> found = In(outlines, scene, cloud);
  ASSERT_EQ(found.size(), 4U);
  for (size_t i = 0; i < found.size(); ++i) {
    EXPECT_TRUE(found[i].given);
    EXPECT_EQ(found[i].given_id, outlines[i].id);
    EXPECT_EQ(found[i].outline.outer, outlines[i].outline.outer);
  }
  EXPECT_EQ(found[0].planes.size(), 1U);
  EXPECT_GT(found[0].wall.size(), 300U);
  EXPECT_TRUE(found[1].roof.empty());
  EXPECT_TRUE(found[1].planes.empty());
  ASSERT_GE(found[2].planes.size(), 2U);
  const double points = 12.0 * 8.0 / (MadeScene::kSpacing_m * MadeScene::kSpacing_m);
  EXPECT_NEAR(static_cast<double>(found[2].roof.size()), points, 0.08 * points);
  EXPECT_TRUE(found[3].roof.empty() && found[3].wall.empty() && found[3].ground.empty());
}

TEST(CandidatesIn, TrustGreenBuildings) {
  MadeScene scene;
  const Rectangle hut = MadeScene::At(0, 0, 5.0, 4.0);
  scene.AddBox(hut, 3.0, kLeaves);
  const std::vector<Candidate> found = In({{hut.Outline(), "green hut"}}, scene, scene.Cloud());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].planes.empty());
  EXPECT_GT(found[0].roof.size(), 300U);
}

TEST(CandidatesIn, TreesOverTheOutlineAreNoRoof) {
  MadeScene scene;
  const Rectangle house = MadeScene::At(0, 0, 12.0, 9.0);
  scene.AddBox(house, 3.5);
  scene.AddTree({6.0, 4.5}, 3.0, 8.0);
  const PointCloud cloud = scene.Cloud();
  const std::vector<Candidate> found = In({{house.Outline(), ""}}, scene, cloud);
  ASSERT_EQ(found.size(), 1U);
  for (const RoofPlane& plane : found[0].planes) EXPECT_NEAR(plane.middle.z(), 43.5, 0.2);
}

}  // namespace
}  // namespace skyquilt::buildings
