#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "buildings/solids/build_solids.h"
#include "tests/buildings/solids/made_shapes.h"

namespace skyquilt::buildings {
namespace {

double TotalArea(const std::vector<RoofFacet>& facets) {
  double area = 0.0;
  for (const RoofFacet& facet : facets) area += Area(facet.outline);
  return area;
}

TEST(RoofFacets, OfSingleParts) {
  const auto facets = [](RoofKind roof) {
    return RoofFacets(MakeShape({0, 12}, {0, 8}, {MakePart(0, 1, 0, 1, roof, true, 106, roof == RoofKind::kFlat ? 106 : 110)}));
  };
  ASSERT_EQ(facets(RoofKind::kFlat).size(), 1U);
  EXPECT_EQ(facets(RoofKind::kFlat)[0].outline.outer.size(), 4U);
  ASSERT_EQ(facets(RoofKind::kGable).size(), 2U);
  for (const RoofFacet& facet : facets(RoofKind::kGable)) {
    EXPECT_NEAR(Area(facet.outline), 48.0, 1e-6);
    EXPECT_NEAR(facet.slope.norm(), 1.0, 1e-9);
    EXPECT_NEAR(facet.HeightAt({6.0, 4.0}), 110.0, 1e-9);
  }
  ASSERT_EQ(facets(RoofKind::kHip).size(), 4U);
  for (const RoofFacet& facet : facets(RoofKind::kHip)) EXPECT_NEAR(facet.slope.norm(), 1.0, 1e-9);
  EXPECT_NEAR(TotalArea(facets(RoofKind::kHip)), 96.0, 1e-6);
}

TEST(RoofFacets, AWingRunsIntoTheRoofBesideIt) {
  // The wing's ridge, 2 m lower than the main one, goes on over the main roof up to where that is as high.
  const Shape shape = MakeShape({0, 5, 10, 20}, {0, 8, 14},
                                {MakePart(0, 3, 0, 1, RoofKind::kGable, true, 106, 110), MakePart(1, 2, 1, 2, RoofKind::kGable, false, 106, 108, 0)});
  const std::vector<RoofFacet> facets = RoofFacets(shape);
  EXPECT_EQ(facets.size(), 4U);
  EXPECT_NEAR(TotalArea(facets), 160.0 + 30.0, 1e-6);
  for (const RoofFacet& facet : facets) {
    if (facet.part == 0) continue;
    // 2.5 m by 6 m outside and a triangle of 2.5 m by 2 m on the main roof, whose valley begins at the eave.
    EXPECT_NEAR(Area(facet.outline), 15.0 + 2.5, 1e-6);
    double deepest = 1e9;
    for (const Eigen::Vector2d& p : facet.outline.outer) deepest = std::min(deepest, p.y());
    EXPECT_NEAR(deepest, 6.0, 1e-6);
  }
}

TEST(RoofFacets, AJoinedWingThatIsLowerStaysOutside) {
  const Shape shape = MakeShape({0, 5, 10, 20}, {0, 8, 14},
                                {MakePart(0, 3, 0, 1, RoofKind::kGable, true, 106, 110), MakePart(1, 2, 1, 2, RoofKind::kGable, false, 103, 105, 0)});
  for (const RoofFacet& facet : RoofFacets(shape)) {
    if (facet.part == 1) {
      EXPECT_NEAR(Area(facet.outline), 15.0, 1e-6);
    }
  }
}

TEST(RoofFacets, ATowerInTheMiddleLeavesADeckWithAHole) {
  const Shape shape = MakeShape({0, 8, 12, 20}, {0, 8, 12, 20},
                                {MakePart(0, 3, 0, 3, RoofKind::kFlat, true, 106, 106), MakePart(1, 2, 1, 2, RoofKind::kFlat, true, 120, 120)});
  const std::vector<RoofFacet> facets = RoofFacets(shape);
  ASSERT_EQ(facets.size(), 2U);
  ASSERT_EQ(facets[0].outline.holes.size(), 1U);
  EXPECT_NEAR(Area(facets[0].outline), 384.0, 1e-6);
}

TEST(RoofFacets, OfEqualRoofsThePartNamedFirstCounts) {
  const Shape shape = MakeShape({0, 6, 12, 18}, {0, 8},
                                {MakePart(0, 2, 0, 1, RoofKind::kGable, true, 106, 110), MakePart(1, 3, 0, 1, RoofKind::kGable, true, 106, 110)});
  double of_first = 0.0;
  const std::vector<RoofFacet> facets = RoofFacets(shape);
  for (const RoofFacet& facet : facets) of_first += facet.part == 0 ? Area(facet.outline) : 0.0;
  EXPECT_EQ(facets.size(), 4U);
  EXPECT_NEAR(of_first, 96.0, 1e-6);
}

TEST(RoofFacets, SliversGoToANeighbour) {
  // The lower part rises above the other's slope in a triangle along the eave of 1 cm by 1 cm.
  const Shape shape = MakeShape(
      {0, 0.01, 12}, {0, 8}, {MakePart(0, 2, 0, 1, RoofKind::kGable, true, 106, 110), MakePart(0, 1, 0, 1, RoofKind::kFlat, true, 106.01, 106.01)});
  const std::vector<RoofFacet> facets = RoofFacets(shape);
  EXPECT_EQ(facets.size(), 2U);
  EXPECT_NEAR(TotalArea(facets), 96.0, 1e-6);
}

TEST(Footprints, OfPartsThatDoNotTouchAreSeveralLargestFirst) {
  const Shape shape = MakeShape({0, 4, 6, 20}, {0, 8},
                                {MakePart(0, 1, 0, 1, RoofKind::kFlat, true, 106, 106), MakePart(2, 3, 0, 1, RoofKind::kFlat, true, 106, 106)});
  const std::vector<Polygon> footprints = Footprints(shape);
  ASSERT_EQ(footprints.size(), 2U);
  EXPECT_NEAR(Area(footprints[0]), 112.0, 1e-6);
  EXPECT_LT((Centroid(footprints[0]) - shape.EnuFrom({13.0, 4.0})).norm(), 1e-6);
}

TEST(Footprints, HaveTheCornersOfTheirWalls) {
  const Shape shape = MakeShape({0, 5, 20}, {0, 8, 14},
                                {MakePart(0, 2, 0, 1, RoofKind::kFlat, true, 106, 106), MakePart(0, 1, 0, 2, RoofKind::kFlat, true, 106, 106)});
  const std::vector<Polygon> footprints = Footprints(shape);
  ASSERT_EQ(footprints.size(), 1U);
  EXPECT_EQ(footprints[0].outer.size(), 6U);
  EXPECT_NEAR(Area(footprints[0]), 160.0 + 30.0, 1e-6);
}

RC_GTEST_PROP(RoofFacets, AreTheHighestRoofOverTheWholeFootprintOnce, (uint32_t seed, bool common_heights)) {
  base::Random random(seed);
  const Shape shape = RandomShape(random, common_heights ? Chance::kCommonHeights : Chance::kCommonLines);
  const std::vector<RoofFacet> facets = RoofFacets(shape);
  double footprint = 0.0;
  for (const Polygon& polygon : Footprints(shape)) footprint += Area(polygon);
  RC_ASSERT(std::abs(TotalArea(facets) - footprint) < 1e-4);
  int differ = 0, looked = 0;
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector2d uv{random.Uniform(shape.u.front(), shape.u.back()), random.Uniform(shape.v.front(), shape.v.back())};
    const double height = RoofHeight(shape, uv);
    const auto holder = std::find_if(facets.begin(), facets.end(), [&](const RoofFacet& facet) { return Contains(facet.outline, uv); });
    const bool at_border =
        std::any_of(facets.begin(), facets.end(), [&](const RoofFacet& facet) { return DistanceToBorder(facet.outline, uv) < 1e-3; });
    if (at_border) continue;
    RC_ASSERT(std::isnan(height) == (holder == facets.end()));
    if (holder == facets.end()) continue;
    ++looked;
    differ += std::abs(holder->HeightAt(uv) - height) > 1e-6 ? 1 : 0;
  }
  // Slivers of 0.01 m2 that were given to neighbours may be hit.
  RC_ASSERT(differ <= 1 + looked / 100);
}

}  // namespace
}  // namespace skyquilt::buildings
