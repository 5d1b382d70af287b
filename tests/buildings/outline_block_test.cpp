#include "buildings/outline_block.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "buildings/solids/build_solids.h"
#include "tests/buildings/sample_buildings.h"

namespace skyquilt::buildings {
namespace {

Candidate Round(double radius_m, const Eigen::Vector2d& centre) {
  constexpr int kCorners = 48;
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
  FollowOutline(candidate, 0.1, &building);
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
