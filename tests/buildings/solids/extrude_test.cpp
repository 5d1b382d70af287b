#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "buildings/solids/build_solids.h"
#include "tests/buildings/solids/made_shapes.h"
#include "tests/buildings/solids/made_solids.h"

namespace skyquilt::buildings {
namespace {

Solid SolidOf(const Shape& shape) {
  return ExtrudeFacets(shape, RoofFacets(shape));
}

// Valid, with these numbers of faces, and this volume.
void ExpectSolid(const Solid& solid, int walls, int roofs, double volume) {
  EXPECT_EQ(TextOf(CheckSolid(solid)), "");
  EXPECT_EQ(FacesOf(solid, FaceKind::kGround), 1);
  EXPECT_EQ(FacesOf(solid, FaceKind::kWall), walls);
  EXPECT_EQ(FacesOf(solid, FaceKind::kRoof), roofs);
  EXPECT_NEAR(Volume(solid), volume, 1e-3 * volume);
}

size_t HolesOf(const Solid& solid, FaceKind kind) {
  size_t holes = 0;
  for (const Face& face : solid.face) holes += face.kind == kind ? face.holes.size() : 0;
  return holes;
}

constexpr RoofKind kFlat = RoofKind::kFlat, kGable = RoofKind::kGable, kHip = RoofKind::kHip;

TEST(ExtrudeFacets, SingleHouses) {
  const auto house = [](RoofKind roof) {
    return SolidOf(MakeShape({0, 12}, {0, 8}, {MakePart(0, 1, 0, 1, roof, true, 106, roof == kFlat ? 106 : 110)}));
  };
  ExpectSolid(house(kFlat), 4, 1, 96.0 * 6.0);
  EXPECT_EQ(house(kFlat).vertex.size(), 8U);
  ExpectSolid(house(kGable), 4, 2, 96.0 * 8.0);
  EXPECT_EQ(house(kGable).vertex.size(), 10U);
  ExpectSolid(house(kHip), 4, 4, 96.0 * 6.0 + 4.0 * (16.0 + 64.0 / 3.0));
  EXPECT_EQ(house(kHip).vertex.size(), 10U);
}

TEST(ExtrudeFacets, APyramidHasOneTip) {
  const Solid solid = SolidOf(MakeShape({0, 9}, {0, 9}, {MakePart(0, 1, 0, 1, kHip, true, 104, 108)}));
  ExpectSolid(solid, 4, 4, 81.0 * (4.0 + 4.0 / 3.0));
  EXPECT_EQ(solid.vertex.size(), 9U);
}

TEST(ExtrudeFacets, CoordinatesAreMillimetres) {
  const Solid solid = SolidOf(MakeShape({0, 12.3456}, {0, 8.7654}, {MakePart(0, 1, 0, 1, kHip, true, 106.1234, 110.9876)}));
  for (const Eigen::Vector3d& v : solid.vertex) EXPECT_LT((1000.0 * v - (1000.0 * v).array().round().matrix()).norm(), 1e-5);
}

TEST(ExtrudeFacets, OneDeckOverPartsOfOneHeight) {
  const Solid solid =
      SolidOf(MakeShape({0, 5, 20}, {0, 8, 14}, {MakePart(0, 2, 0, 1, kFlat, true, 106, 106), MakePart(0, 1, 0, 2, kFlat, true, 106, 106)}));
  ExpectSolid(solid, 6, 1, 190.0 * 6.0);
  EXPECT_EQ(solid.vertex.size(), 12U);
}

TEST(ExtrudeFacets, AWingThatJoinsHasValleysAndNoWallInside) {
  const Solid solid = SolidOf(
      MakeShape({0, 5, 10, 20}, {0, 8, 14}, {MakePart(0, 3, 0, 1, kGable, true, 106, 110), MakePart(1, 2, 1, 2, kGable, false, 106, 108, 0)}));
  ExpectSolid(solid, 8, 4, 160.0 * 8.0 + 30.0 * 7.0 + 2.5 * 2.0 * 2.0 / 3.0);
}

TEST(ExtrudeFacets, AWingAsHighAsTheMainRoofMeetsItsRidgeInAPoint) {
  const Solid solid = SolidOf(
      MakeShape({0, 5, 13, 20}, {0, 8, 14}, {MakePart(0, 3, 0, 1, kGable, true, 106, 110), MakePart(1, 2, 1, 2, kGable, false, 106, 110, 0)}));
  // The main slope beside the wing is cut in two.
  ExpectSolid(solid, 8, 5, 160.0 * 8.0 + 48.0 * 8.0 + 4.0 * 4.0 * 4.0 / 3.0);
}

TEST(ExtrudeFacets, AWingHigherThanTheMainRoofEndsInAGableAboveItsRidge) {
  const Solid solid = SolidOf(
      MakeShape({0, 5, 13, 20}, {0, 8, 14}, {MakePart(0, 3, 0, 1, kGable, true, 106, 108), MakePart(1, 2, 1, 2, kGable, false, 106, 110, 0)}));
  EXPECT_EQ(TextOf(CheckSolid(solid)), "");
  EXPECT_EQ(FacesOf(solid, FaceKind::kWall), 9);
}

TEST(ExtrudeFacets, ATowerInTheMiddleOfAPodium) {
  const Solid solid =
      SolidOf(MakeShape({0, 8, 12, 20}, {0, 8, 12, 20}, {MakePart(0, 3, 0, 3, kFlat, true, 106, 106), MakePart(1, 2, 1, 2, kFlat, true, 120, 120)}));
  ExpectSolid(solid, 8, 2, 400.0 * 6.0 + 16.0 * 14.0);
  EXPECT_EQ(HolesOf(solid, FaceKind::kRoof), 1U);
  EXPECT_EQ(HolesOf(solid, FaceKind::kGround), 0U);
}

TEST(ExtrudeFacets, ATowerAtACornerOrEdgeHasOneWallPerLine) {
  const Solid corner =
      SolidOf(MakeShape({0, 8, 20}, {0, 8, 20}, {MakePart(0, 2, 0, 2, kFlat, true, 106, 106), MakePart(0, 1, 0, 1, kFlat, true, 120, 120)}));
  ExpectSolid(corner, 4 + 2, 2, 400.0 * 6.0 + 64.0 * 14.0);
  EXPECT_EQ(corner.vertex.size(), 4U + 4U + 6U);
  const Solid edge =
      SolidOf(MakeShape({0, 8, 12, 20}, {0, 8, 20}, {MakePart(0, 3, 0, 2, kFlat, true, 106, 106), MakePart(1, 2, 0, 1, kHip, false, 118, 121)}));
  EXPECT_EQ(TextOf(CheckSolid(edge)), "");
  EXPECT_EQ(FacesOf(edge, FaceKind::kWall), 4 + 3);
}

TEST(ExtrudeFacets, RowHousesOfDifferentHeights) {
  const Solid solid = SolidOf(MakeShape(
      {0, 6, 12, 18}, {0, 8},
      {MakePart(0, 1, 0, 1, kGable, true, 106, 110), MakePart(1, 2, 0, 1, kGable, true, 105, 109), MakePart(2, 3, 0, 1, kGable, true, 107, 111)}));
  ExpectSolid(solid, 4 + 2, 6, 48.0 * (8.0 + 7.0 + 9.0));
}

TEST(ExtrudeFacets, RoofsThatCrossAboveAWallHaveWallsToBothSides) {
  // A flat deck at half the height of a gable: its end wall shows above the deck in the middle, the deck's wall beside the eaves.
  const Solid solid =
      SolidOf(MakeShape({0, 10, 16}, {0, 8}, {MakePart(0, 1, 0, 1, kGable, true, 104, 108), MakePart(1, 2, 0, 1, kFlat, true, 106, 106)}));
  ExpectSolid(solid, 4 + 3, 3, 80.0 * 6.0 + 48.0 * 6.0);
}

TEST(ExtrudeFacets, ACourtyardIsAHoleOfTheGround) {
  const Shape shape = MakeShape({0, 4, 16, 20}, {0, 4, 16, 20},
                                {MakePart(0, 3, 0, 1, kFlat, true, 106, 106), MakePart(2, 3, 0, 3, kFlat, true, 106, 106),
                                 MakePart(0, 3, 2, 3, kFlat, true, 106, 106), MakePart(0, 1, 0, 3, kFlat, true, 106, 106)});
  const Solid solid = SolidOf(shape);
  ExpectSolid(solid, 8, 1, (400.0 - 144.0) * 6.0);
  EXPECT_EQ(HolesOf(solid, FaceKind::kGround), 1U);
  EXPECT_EQ(HolesOf(solid, FaceKind::kRoof), 1U);
}

TEST(ExtrudeFacets, TowersThatTouchAtACornerAreFoundInvalid) {
  const Solid solid = SolidOf(MakeShape(
      {0, 5, 10}, {0, 5, 10},
      {MakePart(0, 2, 0, 2, kFlat, true, 106, 106), MakePart(0, 1, 0, 1, kFlat, true, 120, 120), MakePart(1, 2, 1, 2, kFlat, true, 118, 118)}));
  const std::vector<SolidProblem> problems = CheckSolid(solid);
  ASSERT_EQ(problems.size(), 1U) << TextOf(problems);
  EXPECT_EQ(problems[0].code, 304);
}

TEST(ExtrudeFacets, StepsOfMillimetresAreNoWalls) {
  const Solid solid = SolidOf(MakeShape({0, 6, 12.002, 18}, {0, 8, 8.002},
                                        {MakePart(0, 1, 0, 1, kGable, true, 106, 110), MakePart(1, 2, 0, 2, kGable, true, 106.002, 110.003),
                                         MakePart(2, 3, 0, 1, kFlat, true, 103, 103)}));
  EXPECT_EQ(TextOf(CheckSolid(solid)), "");
  EXPECT_EQ(FacesOf(solid, FaceKind::kWall), 5);
}

TEST(ExtrudeFacets, OfNothingOrNoNumbersIsEmpty) {
  Shape shape = MakeShape({0, 12}, {0, 8}, {MakePart(0, 1, 0, 1, kGable, true, 106, 110)});
  EXPECT_TRUE(ExtrudeFacets(shape, {}).Empty());
  std::vector<RoofFacet> facets = RoofFacets(shape);
  facets[1].offset = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(ExtrudeFacets(shape, facets).Empty());
  shape.parts[0].ridge_z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(SolidOf(shape).Empty());
  shape.parts[0].ridge_z = 110.0;
  shape.ground_z = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(SolidOf(shape).Empty());
}

TEST(ExtrudeFacets, ARoofBelowTheGroundIsFoundInvalid) {
  const Solid solid = SolidOf(MakeShape({0, 12}, {0, 8}, {MakePart(0, 1, 0, 1, kFlat, true, 95, 95)}));
  EXPECT_FALSE(CheckSolid(solid).empty());
}

TEST(ExtrudeBlock, StraightPointsAreDroppedAndHolesAreCourtyards) {
  const Polygon footprint{{{500.0, 100.0}, {505.0, 100.0}, {510.0, 100.0}, {510.0, 107.0}, {500.0, 107.0}},
                          {{{502.0, 102.0}, {502.0, 104.0}, {504.0, 104.0}, {504.0, 102.0}}}};
  const Solid solid = ExtrudeBlock(footprint, 50.0, 56.5);
  ExpectSolid(solid, 8, 1, 66.0 * 6.5);
  EXPECT_EQ(solid.vertex.size(), 16U);
  EXPECT_EQ(HolesOf(solid, FaceKind::kGround), 1U);
  EXPECT_NEAR(Area(solid, FaceKind::kGround), 66.0, 1e-3);
}

TEST(ExtrudeBlock, SlopingOutlinesWithNearPoints) {
  // A polygon of 60 sides; points nearer than 3 mm become one.
  Polygon round;
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.1047197551 * i;
    round.outer.emplace_back(9.0 * std::cos(angle), 5.0 * std::sin(angle));
    if (i % 10 == 0) round.outer.emplace_back(round.outer.back() + Eigen::Vector2d(0.0005, 0.0008));
  }
  const Solid solid = ExtrudeBlock(round, 0.0, 4.0);
  ExpectSolid(solid, 60, 1, 4.0 * Area(round));
}

TEST(ExtrudeBlock, CourtyardsThatTouchTheOutlineOrEachOtherAreDrawnBack) {
  // Cells of 4 m: a courtyard that touches the outside by a corner, and two that touch each other.
  const std::vector<uint8_t> one = {1, 1, 1, 1, 0, 1, 1, 1, 0}, two = {1, 1, 1, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1, 1, 1, 1};
  for (const auto& [mask, n] : {std::pair(one, 3), std::pair(two, 4)}) {
    const Polygon outline = OutlinesOf(mask, n, n, {300.0, -200.0}, 4.0).at(0);
    const Solid solid = ExtrudeBlock(outline, 10.0, 20.0);
    EXPECT_EQ(TextOf(CheckSolid(solid)), "");
    EXPECT_NEAR(Volume(solid), 10.0 * Area(outline), 2.0);
    EXPECT_EQ(HolesOf(solid, FaceKind::kGround), outline.holes.size());
  }
}

TEST(ExtrudeBlock, OfNothingOrWithoutHeight) {
  EXPECT_TRUE(ExtrudeBlock(Polygon{}, 0.0, 5.0).Empty());
  const Polygon box{{{0, 0}, {4, 0}, {4, 3}, {0, 3}}, {}};
  EXPECT_FALSE(CheckSolid(ExtrudeBlock(box, 5.0, 5.0)).empty());
  EXPECT_TRUE(ExtrudeBlock(box, 5.0, std::numeric_limits<double>::quiet_NaN()).Empty());
}

}  // namespace
}  // namespace skyquilt::buildings
