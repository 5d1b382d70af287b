#include "buildings/outline_block.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "buildings/solids/build_solids.h"
#include "tests/buildings/sample_buildings.h"

namespace skyquilt::buildings {
namespace {

Candidate Round(double radius_m, const Eigen::Vector2d& centre) {
  constexpr int kCorners = 300;
  Candidate candidate;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    candidate.outline.outer.push_back(centre + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return candidate;
}

TEST(OutlineBlock, RoundBuildingsHaveTheAreaOfTheirOutline) {
  HousePlan plan;
  plan.roof = RoofKind::kFlat;
  plan.ridge_z = plan.eave_z;
  plan.length_m = plan.width_m = 10.0;
  Building building = MadeHouse(plan, 1);
  building.measures.height_m.sigma = 0.1;
  const Candidate candidate = Round(5.0, plan.origin);
  ASSERT_TRUE(LeavesCorners(candidate, building.shape));
  FollowOutline(candidate, 0.1, {}, &building);
  const double area = std::numbers::pi * 25.0, height = building.measures.height_m.value;
  // The simplified outline is at most 0.2 m inside the circle.
  EXPECT_NEAR(building.measures.footprint_m2.value, area, 0.05 * area);
  EXPECT_NEAR(Area(building.footprint), building.measures.footprint_m2.value, 1e-9);
  EXPECT_NEAR(building.measures.volume_m3.value, building.measures.footprint_m2.value * height, 1e-6);
  EXPECT_NEAR(Volume(building.lod22), building.measures.volume_m3.value, 0.01 * area);
  EXPECT_TRUE(building.lod22_valid);
  EXPECT_TRUE(CheckSolid(building.lod22).empty());
  EXPECT_GT(building.measures.footprint_m2.sigma, 0.5);  // half a GSD on 31 m of rim
  EXPECT_GE(building.measures.volume_m3.sigma, 0.1 * building.measures.footprint_m2.value);
  geo::PlaceAccuracy accuracy;
  accuracy.scale_percent = 5.0;
  FollowOutline(candidate, 0.1, accuracy, &building);
  EXPECT_GE(building.measures.footprint_m2.sigma, 0.1 * building.measures.footprint_m2.value);
}

// Outlines of rasters have stairs; walls that are none of the cells' directions have not.
TEST(OutlineBlock, StairsBecomeStraightWalls) {
  constexpr double kCell_m = 0.2;
  constexpr int kCells = 80;
  std::vector<uint8_t> mask(kCells * kCells, 0);
  const Eigen::Vector2d low(1.0, 1.0), along = Eigen::Vector2d(14.0, 6.0).normalized(), across(-along.y(), along.x());
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column) {
      const Eigen::Vector2d at = kCell_m * Eigen::Vector2d(column + 0.5, row + 0.5) - low - Eigen::Vector2d(3.0, 0.0);
      // A triangle: it fills half of its rectangle.
      const double u = along.dot(at), v = across.dot(at);
      if (u >= 0.0 && v >= 0.0 && u / 11.0 + v / 8.0 <= 1.0) mask[static_cast<size_t>(row * kCells + column)] = 1;
    }
  }
  Candidate candidate;
  candidate.outline = OutlinesOf(mask, kCells, kCells, Eigen::Vector2d::Zero(), kCell_m).at(0);
  ASSERT_GT(candidate.outline.outer.size(), 50U);
  Building building = MadeHouse({}, 1);
  FollowOutline(candidate, 0.06, {}, &building);
  EXPECT_LE(building.footprint.outer.size(), 6U);
  EXPECT_NEAR(Area(building.footprint), 44.0, 0.05 * 44.0);
  // Given outlines stay as they are.
  candidate.given = true;
  FollowOutline(candidate, 0.06, {}, &building);
  EXPECT_EQ(building.footprint.outer.size(), candidate.outline.outer.size());
}

TEST(OutlineBlock, RectanglesFillTheirs) {
  HousePlan plan;
  const Building building = MadeHouse(plan, 1);
  Candidate candidate;
  candidate.outline = building.footprint;
  EXPECT_FALSE(LeavesCorners(candidate, building.shape));
}

}  // namespace
}  // namespace skyquilt::buildings
