// Places that invite houses that are not there, or hide those that are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "buildings/candidates/find_candidates.h"
#include "tests/buildings/candidates/made_scene.h"

namespace skyquilt::buildings {
namespace {

constexpr Color kBark{112, 104, 98};

std::vector<Candidate> FoundIn(const MadeScene& scene, const PointCloud& cloud) {
  base::ThreadPool threads(2);
  return FindCandidates(cloud, scene.Ground(), {}, MadeScene::kGsd_m, threads);
}
std::vector<Candidate> FoundIn(const MadeScene& scene) {
  return FoundIn(scene, scene.Cloud());
}

// A valley along north, 6 m deep and 12 m wide at its floor, with banks that rise over 9 m.
double Valley(const Eigen::Vector2d& at) {
  return 6.0 * std::clamp((std::abs(at.x()) - 6.0) / 9.0, 0.0, 1.0);
}

MadeScene BridgeOverValley(double half_m, double width_m) {
  MadeScene scene(half_m);
  scene.SetTerrain(Valley);
  scene.AddBox(MadeScene::At(0, 0, 40.0, width_m), 6.0, kConcrete);
  return scene;
}

TEST(SpecialPlaces, BridgesAreNoBuildings) {
  EXPECT_TRUE(FoundIn(BridgeOverValley(22.0, 5.0)).empty());
  EXPECT_TRUE(FoundIn(BridgeOverValley(22.0, 18.0)).empty()) << "nearly as wide as long";
}

TEST(SpecialPlaces, BridgesWithRampsAreNoBuildings) {
  // Over a level railway, between ramps that fall by one in eight.
  MadeScene scene(40.0);
  const Polygon deck = MadeScene::At(0, 0, 76.0, 7.0, 20).Outline();
  const Eigen::Vector2d along = MadeScene::At(0, 0, 1, 1, 20).axis;
  scene.Add({[=](const Eigen::Vector2d& at) { return Contains(deck, at) ? std::clamp((38.0 - std::abs(at.dot(along))) / 8.0, 0.0, 4.0) : 0.0; },
             kConcrete,
             {deck}});
  EXPECT_TRUE(FoundIn(scene).empty());
}

TEST(SpecialPlaces, BridgesThatLeaveTheSurveyAtOneEndAreNoBuildings) {
  MadeScene scene = BridgeOverValley(22.0, 6.0);
  PointCloud cloud = scene.Cloud();
  std::erase_if(cloud.points, [](const SurfacePoint& point) { return point.position.x() > 4.0F; });
  EXPECT_TRUE(FoundIn(scene, cloud).empty());
}

TEST(SpecialPlaces, AHouseWhoseRoofMeetsTheSlopeIsFound) {
  MadeScene scene(18.0);
  // Its flat roof is level with the ground behind it.
  scene.SetTerrain([](const Eigen::Vector2d& at) { return 5.0 * std::clamp((at.y() + 4.0) / 9.0, 0.0, 1.0); });
  const Rectangle house = MadeScene::At(0, 0, 12.0, 10.0);
  scene.AddBox(house, 5.0);
  const std::vector<Candidate> found = FoundIn(scene);
  ASSERT_EQ(found.size(), 1U);
  // Of its roof, the part that is well above the ground.
  EXPECT_GT(Area(found.front().outline), 0.5 * 120.0);
  EXPECT_LT(Area(found.front().outline), 1.05 * 120.0);
}

TEST(SpecialPlaces, WoodsWithoutLeavesAreNoBuildings) {
  for (const double bumps_m : {0.05, 0.15, 0.35}) {
    MadeScene scene(20.0);
    for (int i = 0; i < 36; ++i)
      scene.AddTree({-16.0 + 6.4 * (i % 6), -16.0 + 6.4 * (i / 6)}, 2.4 + 0.35 * (i % 4), 6.0 + 0.9 * (i % 5), kBark, bumps_m);
    EXPECT_TRUE(FoundIn(scene).empty()) << bumps_m;
  }
}

TEST(SpecialPlaces, SingleTreesWithoutLeavesAreNoBuildings) {
  for (const double radius : {2.2, 3.0, 4.0}) {
    for (const double bumps_m : {0.05, 0.15, 0.35}) {
      MadeScene scene(8.0);
      scene.AddTree({0, 0}, radius, 7.0, kBark, bumps_m);
      EXPECT_TRUE(FoundIn(scene).empty()) << radius << " " << bumps_m;
    }
  }
}

TEST(SpecialPlaces, GreySurveysStillHaveTheirHouses) {
  // Nothing is green here, so that shapes alone must do.
  MadeScene scene(24.0);
  scene.AddBox(MadeScene::At(-14, -14, 3.6, 3.2, 10), 2.6);
  scene.AddGable(MadeScene::At(-10, 12, 5.0, 4.0, 30), 2.5, 40);
  scene.AddGable(MadeScene::At(10, -10, 12.0, 8.0, 60), 4.0, 45);
  scene.AddTree({14, 14}, 3.5, 8.0, kBark);
  EXPECT_EQ(FoundIn(scene).size(), 3U);
}

// Like the roof of a round pavilion: many planes, but not as many as a crown has at this GSD.
TEST(SpecialPlaces, SmallRoofsOfManyPlanesAreFound) {
  MadeScene scene(9.0, kLawn);
  const Polygon outline = MadeScene::At(0, 0, 6.0, 6.0).Outline();
  scene.Add(
      {[=](const Eigen::Vector2d& at) { return Contains(outline, at) ? 2.5 + 0.8 * (3.0 - at.cwiseAbs().maxCoeff()) : 0.0; }, kRedTiles, {outline}});
  const std::vector<Candidate> found = FoundIn(scene);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().planes.size(), 4U);
}

TEST(SpecialPlaces, ABuildingAtTheEdgeOfTheSurveyIsKnownToBeCut) {
  MadeScene scene(16.0);
  scene.AddBox(MadeScene::At(12.0, 0, 16.0, 9.0), 6.0);  // its last 4 m are beyond
  scene.AddBox(MadeScene::At(-8.0, 0, 9.0, 8.0), 6.0);
  PointCloud cloud = scene.Cloud();
  std::erase_if(cloud.points, [](const SurfacePoint& point) { return point.position.x() > 16.0F; });
  const std::vector<Candidate> found = FoundIn(scene, cloud);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].edge_share, 9.0 / 42.0, 0.1);
  EXPECT_EQ(found[1].edge_share, 0.0);
}

TEST(SpecialPlaces, GapsInTheSurveyAreNoEdges) {
  MadeScene scene(16.0);
  scene.AddBox(MadeScene::At(0, 0, 12.0, 9.0), 6.0);
  PointCloud cloud = scene.Cloud();
  std::erase_if(cloud.points, [](const SurfacePoint& point) {
    return point.position.x() > 6.1F && point.position.x() < 9.0F && std::abs(point.position.y()) < 5.0F && point.position.z() < 1.0F;
  });
  const std::vector<Candidate> found = FoundIn(scene, cloud);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().edge_share, 0.0);
}

// Nothing around it shows that it stands out.
TEST(SpecialPlaces, ABuildingThatFillsTheSurveyNeedsAGivenOutline) {
  MadeScene scene(8.0);
  scene.AddBox(MadeScene::At(0, 0, 15.0, 15.0), 7.0);
  PointCloud cloud = scene.Cloud();
  std::erase_if(cloud.points, [](const SurfacePoint& point) { return point.position.z() < 6.0F; });
  EXPECT_TRUE(FoundIn(scene, cloud).empty());
  base::ThreadPool threads(2);
  const std::vector<GivenOutline> outlines = {{MadeScene::At(0, 0, 15.0, 15.0).Outline(), "hall"}};
  const std::vector<Candidate> given = CandidatesIn(outlines, cloud, scene.Ground(), {}, MadeScene::kGsd_m, threads);
  ASSERT_EQ(given.size(), 1U);
  EXPECT_GT(given.front().edge_share, 0.9);
  EXPECT_GT(given.front().roof.size(), 1000U);
}

// By its shape nobody can tell a lorry from a shed, so its size decides.
TEST(SpecialPlaces, LorriesAreFoundAsSheds) {
  MadeScene scene(12.0);
  scene.AddBox(MadeScene::At(-6, 0, 3.0, 2.0, 40), 2.4);  // a van: below the least area
  scene.AddBox(MadeScene::At(4, 0, 12.0, 2.5, 40), 3.8);
  const std::vector<Candidate> found = FoundIn(scene);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(Area(found.front().outline), 30.0, 4.0);
}

}  // namespace
}  // namespace skyquilt::buildings
