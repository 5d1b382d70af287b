#include "buildings/make_buildings.h"

#include <gtest/gtest.h>

#include <cmath>

#include "buildings/solids/build_solids.h"
#include "tests/buildings/sample_buildings.h"
#include "tests/buildings/sample_clouds.h"
#include "tests/support/error_of.h"

namespace skyquilt::buildings {
namespace {

// A gable house, a flat one, and two trees beside them; ground at 100 m.
struct MadePlace {
  std::vector<Building> truth;
  MadeCloud made;
  GroundGrid ground = LevelGround({45.0, 30.0}, 60.0, 100.0);
};

MadePlace TwoHouses() {
  HousePlan gable;
  gable.yaw_rad = 0.2;
  HousePlan flat;
  flat.roof = RoofKind::kFlat;
  flat.eave_z = flat.ridge_z = 106.0;
  flat.origin = {55.0, 28.0};
  flat.length_m = 15.0;
  flat.width_m = 10.0;
  flat.yaw_rad = 0.2;
  MadePlace place{.truth = {MadeHouse(gable, 1), MadeHouse(flat, 2)}, .made = {}};
  place.made = MadeCloudOf(place.truth, {.noise_m = 0.05, .normal_noise = 0.05});
  AddTree(&place.made, {45.0, 20.0, 104.0}, 3.0);
  AddTree(&place.made, {48.0, 45.0, 103.0}, 2.0);
  return place;
}

BuildingsInput InputOf(const MadePlace& place) {
  BuildingsInput input;
  input.cloud = &place.made.cloud;
  input.ground = &place.ground;
  input.georeferenced = true;
  input.gsd_m = 0.19;
  return input;
}

class MakeBuildingsTest : public ::testing::Test {
 protected:
  MadePlace place_ = TwoHouses();
  BuildingsInput input_ = InputOf(place_);
  base::ThreadPool threads_{2};
};

TEST_F(MakeBuildingsTest, FindsTheHousesAndNoTrees) {
  const BuildingSet set = MakeBuildings(input_, threads_);
  ASSERT_EQ(set.buildings.size(), 2U);
  EXPECT_TRUE(set.metric);
  EXPECT_EQ(set.scale_source, "geo-reference");
  for (size_t i = 0; i < 2; ++i) {
    const Building& found = set.buildings[i];
    const Building& truth = place_.truth[i];
    EXPECT_EQ(found.id, truth.id);  // from west to east
    EXPECT_EQ(found.roof, truth.roof);
    EXPECT_TRUE(found.accepted) << found.note;
    EXPECT_TRUE(CheckSolid(found.lod22).empty());
    EXPECT_NEAR(found.measures.length_m.value, truth.measures.length_m.value, 0.3);
    EXPECT_NEAR(found.measures.width_m.value, truth.measures.width_m.value, 0.3);
    EXPECT_NEAR(found.measures.height_m.value, truth.measures.height_m.value, 0.15);
    EXPECT_GT(found.measures.length_m.sigma, 0.0);
    EXPECT_NEAR(Volume(found.lod22), found.measures.volume_m3.value, 0.01 * found.measures.volume_m3.value);
  }
}

TEST_F(MakeBuildingsTest, AreTheSameForAnyNumberOfThreads) {
  base::ThreadPool one(1), three(3);
  const BuildingSet a = MakeBuildings(input_, one), b = MakeBuildings(input_, three);
  ASSERT_EQ(a.buildings.size(), b.buildings.size());
  for (size_t i = 0; i < a.buildings.size(); ++i) {
    EXPECT_EQ(a.buildings[i].shape.u, b.buildings[i].shape.u);
    EXPECT_EQ(a.buildings[i].measures.length_m.sigma, b.buildings[i].measures.length_m.sigma);
  }
}

TEST_F(MakeBuildingsTest, WithoutScaleAreNotMetricAndAScaleBarGivesIt) {
  input_.georeferenced = false;
  const BuildingSet local = MakeBuildings(input_, threads_);
  EXPECT_FALSE(local.metric);
  BuildingsInput measured = input_;
  measured.accuracy.scale_percent = 0.5;  // the survey had scale bars
  EXPECT_TRUE(MakeBuildings(measured, threads_).metric);
  EXPECT_EQ(MakeBuildings(measured, threads_).scale_source, "scale bar");
  input_.options.scale_bar = {0, 0, 0, 3, 4, 0, 10};  // 5 units are 10 m
  const BuildingSet scaled = MakeBuildings(input_, threads_);
  EXPECT_TRUE(scaled.metric);
  EXPECT_EQ(scaled.scale, 2.0);
  ASSERT_EQ(scaled.buildings.size(), local.buildings.size());
  const Measures &m = scaled.buildings[0].measures, &one = local.buildings[0].measures;
  EXPECT_DOUBLE_EQ(m.length_m.value, 2.0 * one.length_m.value);
  EXPECT_DOUBLE_EQ(m.footprint_m2.sigma, 4.0 * one.footprint_m2.sigma);
  EXPECT_DOUBLE_EQ(m.volume_m3.value, 8.0 * one.volume_m3.value);
  EXPECT_DOUBLE_EQ(m.yaw_deg.value, one.yaw_deg.value);
  input_.options.scale_bar = {1, 1, 1, 1, 1, 1, 2};
  EXPECT_NE(UsageErrorOf([&] { MakeBuildings(input_, threads_); }).find("two points are the same"), std::string::npos);
}

TEST_F(MakeBuildingsTest, OutlinesThatFitNothingGiveSoundBuildingsOrNone) {
  // Outlines that fit nothing: across houses, trees and the ground between.
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector2d corner(12.0 + 4.7 * (i % 12), 22.0 + 4.3 * (i / 12));
    Polygon box;
    for (const Eigen::Vector2d& step : {Eigen::Vector2d(0, 0), Eigen::Vector2d(9, 0), Eigen::Vector2d(9, 7), Eigen::Vector2d(0, 7)}) {
      box.outer.push_back(corner + step);
    }
    input_.footprints.push_back({box, std::to_string(i)});
  }
  const BuildingSet set = MakeBuildings(input_, threads_);
  EXPECT_GT(set.buildings.size(), 5U);
  EXPECT_LT(set.buildings.size(), 40U);
  for (const Building& building : set.buildings) {
    EXPECT_GE(building.measures.ridge_m.value, building.measures.eave_m.value) << building.given_id << " " << NameOf(building.roof);
    EXPECT_GE(building.measures.pitch_deg.value, 0.0) << building.given_id;
    EXPECT_GE(building.measures.height_m.value, 0.5) << building.given_id;
    EXPECT_TRUE(CheckSolid(building.lod22).empty()) << building.given_id;
  }
}

TEST_F(MakeBuildingsTest, MeasureGivenOutlinesAndNothingElse) {
  input_.footprints = {{place_.truth[1].footprint, "cadastre 7"}, {{.outer = {{0, 0}, {5, 0}, {5, 5}, {0, 5}}, .holes = {}}, "empty lot"}};
  const BuildingSet set = MakeBuildings(input_, threads_);
  ASSERT_EQ(set.buildings.size(), 1U);
  EXPECT_TRUE(set.buildings[0].given);
  EXPECT_EQ(set.buildings[0].given_id, "cadastre 7");
  EXPECT_NEAR(set.buildings[0].measures.height_m.value, 6.0, 0.15);
}

// Points that were matched in photos: on the ground where the field has a house, on the roof of the other.
TEST_F(MakeBuildingsTest, MatchedPointsDenyRoofsThatOnlyTheFieldHas) {
  const Eigen::Vector2d flat = Centroid(place_.truth[1].footprint);
  for (int i = 0; i < 2; ++i) input_.matched.emplace_back(flat.x() + i, flat.y(), 100.0);
  EXPECT_EQ(MakeBuildings(input_, threads_).buildings.size(), 2U) << "two wrong matches";
  for (int i = 0; i < 3; ++i) input_.matched.emplace_back(flat.x() - i, flat.y() + 1.0, 100.2);
  const Eigen::Vector2d gable = Centroid(place_.truth[0].footprint);
  for (int i = 0; i < 5; ++i) input_.matched.emplace_back(gable.x() + i, gable.y(), 107.0);
  const BuildingSet set = MakeBuildings(input_, threads_);
  ASSERT_EQ(set.buildings.size(), 1U);
  EXPECT_EQ(set.buildings[0].roof, RoofKind::kGable);
  // Whoever gives an outline knows of the house.
  input_.footprints = {{place_.truth[1].footprint, "given"}};
  EXPECT_EQ(MakeBuildings(input_, threads_).buildings.size(), 1U);
}

// A roof of many small steps is neither flat nor gable nor hip.
TEST_F(MakeBuildingsTest, WhatNoRoofDescribesIsABlock) {
  for (size_t i = 0; i < place_.made.surface.size(); ++i) {
    if (place_.made.surface[i] != MadeSurface::kRoof || place_.made.building[i] != 2) continue;
    SurfacePoint& point = place_.made.cloud.points[i];
    const auto step = static_cast<float>(static_cast<int>(std::floor((point.position.x() + point.position.y()) / 3.0F)) & 3);
    point.position.z() += 0.9F * step;
  }
  const BuildingSet set = MakeBuildings(input_, threads_);
  int blocks = 0;
  for (const Building& building : set.buildings) {
    EXPECT_TRUE(CheckSolid(building.lod22).empty());
    if (building.roof != RoofKind::kOther) continue;
    EXPECT_FALSE(building.accepted);
    ++blocks;
    for (const Part& part : building.shape.parts) EXPECT_EQ(part.eave_z, part.ridge_z);
    EXPECT_NE(building.note.find("block"), std::string::npos);
  }
  EXPECT_EQ(blocks, 1);
}

}  // namespace
}  // namespace skyquilt::buildings
