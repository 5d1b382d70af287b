#include "buildings/shape/find_shape.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/buildings/shape/made_candidates.h"

namespace skyquilt::buildings {
namespace {

constexpr double kGsd_m = 0.19;

ShapeGuess Found(const MadeCandidate& made) {
  const std::optional<ShapeGuess> guess = FindShape(made.candidate, FindDirection(made.candidate, made.cloud), made.cloud, 100.0, kGsd_m);
  if (!guess) throw std::runtime_error("no shape was found");
  return *guess;
}

Shape Rectangle(double length, double width, const Part& part, double yaw_deg = 0.0) {
  Shape shape = AxesAt(yaw_deg, {-0.5 * length, 0.5 * length}, {-0.5 * width, 0.5 * width});
  shape.parts = {part};
  return shape;
}

// Whether the ridge of the first part runs along the u axis of `truth`.
bool RunsAlongU(const Shape& found, const Shape& truth) {
  const Part& part = found.parts.front();
  const Eigen::Vector2d ridge = part.along_u ? found.AxisU() : found.AxisV();
  return std::abs(ridge.dot(truth.AxisU())) > 0.7;
}

void ExpectSound(const Shape& shape) {
  ASSERT_FALSE(shape.parts.empty());
  EXPECT_TRUE(std::is_sorted(shape.u.begin(), shape.u.end()));
  EXPECT_TRUE(std::is_sorted(shape.v.begin(), shape.v.end()));
  for (const Part& part : shape.parts) {
    EXPECT_LT(part.u0, part.u1);
    EXPECT_LT(part.v0, part.v1);
    EXPECT_LT(static_cast<size_t>(part.u1), shape.u.size());
    EXPECT_LT(static_cast<size_t>(part.v1), shape.v.size());
    EXPECT_TRUE(std::isfinite(part.eave_z) && std::isfinite(part.ridge_z));
    EXPECT_GE(part.ridge_z, part.eave_z);
  }
}

TEST(FindShape, OneRectangleWithItsRoof) {
  const Part flat = FlatPart(0, 1, 0, 1, 110.0);
  const Part gable = PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 105.0, 109.0);
  const Part across = PitchedPart(RoofKind::kGable, 0, 1, 0, 1, false, 105.0, 110.0);
  const Part hip = PitchedPart(RoofKind::kHip, 0, 1, 0, 1, true, 105.0, 108.0);
  for (const Part& part : {flat, gable, across, hip}) {
    for (const double yaw_deg : {0.0, 31.0, 100.0}) {
      const Shape truth = Rectangle(13.0, 9.0, part, yaw_deg);
      const ShapeGuess guess = Found(MakeCandidate(truth));
      SCOPED_TRACE(std::string(NameOf(part.roof)) + " at " + std::to_string(yaw_deg));
      ExpectSound(guess.shape);
      EXPECT_TRUE(guess.manhattan);
      ASSERT_EQ(guess.shape.parts.size(), 1U);
      EXPECT_GT(OverlapOf(guess.shape, truth), 0.95);
      EXPECT_EQ(guess.shape.parts[0].roof, part.roof);
      EXPECT_NEAR(guess.shape.parts[0].eave_z, part.eave_z, 0.25);
      EXPECT_NEAR(guess.shape.parts[0].ridge_z, part.ridge_z, 0.25);
      if (part.roof == RoofKind::kGable) {
        EXPECT_EQ(RunsAlongU(guess.shape, truth), part.along_u);
      }
    }
  }
}

// The walls of a house with wide eaves are where they were seen, and else at the roof's edge.
TEST(FindShape, WallsWinOverTheRoofsEdge) {
  const Shape truth = Rectangle(12.0, 9.0, PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 105.0, 109.0), 20.0);
  const Shape seen = Found(MakeCandidate(truth, {.overhang_m = 0.6, .wall_share = 0.4})).shape;
  const Shape unseen = Found(MakeCandidate(truth, {.overhang_m = 0.6, .wall_share = 0.0})).shape;
  EXPECT_NEAR(seen.u.back() - seen.u.front(), 12.0, 0.3);
  EXPECT_NEAR(seen.v.back() - seen.v.front(), 9.0, 0.3);
  EXPECT_NEAR(unseen.u.back() - unseen.u.front(), 13.2, 0.4);
  EXPECT_NEAR(unseen.v.back() - unseen.v.front(), 10.2, 0.4);
}

TEST(FindShape, BoxesOnADeckAreNoParts) {
  Shape truth = AxesAt(12.0, {-12.0, 3.0, 6.4, 12.0}, {-8.0, 1.0, 4.0, 8.0});
  truth.parts = {FlatPart(0, 3, 0, 3, 112.0)};
  const Shape found = Found(MakeCandidate(truth, {}, {FlatPart(1, 2, 1, 2, 114.4)})).shape;
  ASSERT_EQ(found.parts.size(), 1U);
  EXPECT_NEAR(found.parts[0].eave_z, 112.0, 0.1);
  EXPECT_GT(OverlapOf(found, truth), 0.97);
}

// The same house with a box of 8 x 7 m on it, which is a storey.
TEST(FindShape, SetBackTowerStandsOnItsPodium) {
  Shape truth = AxesAt(-25.0, {-12.0, -4.0, 4.0, 12.0}, {-9.0, -3.0, 4.0, 9.0});
  truth.parts = {FlatPart(0, 3, 0, 3, 106.0), FlatPart(1, 2, 1, 2, 116.0)};
  const Shape found = Found(MakeCandidate(truth)).shape;
  ExpectSound(found);
  ASSERT_EQ(found.parts.size(), 2U);
  EXPECT_GT(OverlapOf(found, truth), 0.97);
  EXPECT_NEAR(found.parts[0].eave_z, 106.0, 0.15);
  EXPECT_NEAR(found.parts[1].eave_z, 116.0, 0.15);
  EXPECT_NEAR((found.MaxOf(found.parts[1], false) - found.MinOf(found.parts[1], false)).prod(), 56.0, 4.0);
}

TEST(FindShape, WingOfGablesJoinsTheMainRoof) {
  Shape l_shape = AxesAt(40.0, {-8.0, 1.0, 8.0}, {-9.0, 0.0, 8.0});
  l_shape.parts = {PitchedPart(RoofKind::kGable, 0, 2, 1, 2, true, 105.0, 109.0), PitchedPart(RoofKind::kGable, 0, 1, 0, 1, false, 105.0, 108.5, 0)};
  Shape t_shape = AxesAt(77.0, {-10.0, -3.0, 4.0, 10.0}, {-8.0, 0.0, 9.0});
  t_shape.parts = {PitchedPart(RoofKind::kGable, 0, 3, 1, 2, true, 105.0, 109.0), PitchedPart(RoofKind::kGable, 1, 2, 0, 1, false, 105.0, 107.5, 0)};
  for (const Shape& truth : {l_shape, t_shape}) {
    const Shape found = Found(MakeCandidate(truth)).shape;
    ExpectSound(found);
    ASSERT_EQ(found.parts.size(), 2U);
    EXPECT_GT(OverlapOf(found, truth), 0.95);
    EXPECT_EQ(found.parts[0].joins, -1);
    EXPECT_EQ(found.parts[1].joins, 0);
    EXPECT_EQ(found.parts[1].roof, RoofKind::kGable);
    EXPECT_NE(found.parts[0].along_u, found.parts[1].along_u);
    EXPECT_NEAR(found.parts[0].ridge_z, 109.0, 0.2);
    EXPECT_NEAR(found.parts[1].ridge_z, truth.parts[1].ridge_z, 0.25);
  }
}

TEST(FindShape, HouseTwiceAsWideIsNoPairOfHouses) {
  const Shape truth = Rectangle(22.0, 18.0, PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 106.0, 112.0), 8.0);
  EXPECT_EQ(Found(MakeCandidate(truth)).shape.parts.size(), 1U);
}

TEST(FindShape, RowOfHousesWithDifferentRidges) {
  Shape stepped = AxesAt(15.0, {-9.0, 0.0, 8.0}, {-5.0, 5.0});
  stepped.parts = {PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 105.0, 109.0), PitchedPart(RoofKind::kGable, 1, 2, 0, 1, true, 107.0, 111.0)};
  Shape turned = stepped;
  turned.parts[1] = PitchedPart(RoofKind::kGable, 1, 2, 0, 1, false, 105.0, 109.0);
  for (const Shape& truth : {stepped, turned}) {
    const Shape found = Found(MakeCandidate(truth)).shape;
    ExpectSound(found);
    ASSERT_EQ(found.parts.size(), 2U);
    EXPECT_GT(OverlapOf(found, truth), 0.95);
    EXPECT_EQ(found.parts[0].joins, -1);
    EXPECT_EQ(found.parts[1].joins, -1);
    EXPECT_EQ(found.parts[0].along_u == found.parts[1].along_u, truth.parts[0].along_u == truth.parts[1].along_u);
  }
}

TEST(FindShape, CourtyardStaysOpen) {
  Shape truth = AxesAt(63.0, {-15.0, -6.0, 6.0, 15.0}, {-13.0, -5.0, 5.0, 13.0});
  truth.parts = {FlatPart(0, 3, 0, 1, 112.0), FlatPart(0, 3, 2, 3, 112.0), FlatPart(0, 1, 0, 3, 112.0), FlatPart(2, 3, 0, 3, 112.0)};
  const Shape found = Found(MakeCandidate(truth)).shape;
  ExpectSound(found);
  EXPECT_EQ(found.parts.size(), 4U);
  EXPECT_GT(OverlapOf(found, truth), 0.97);
  EXPECT_TRUE(std::isnan(RoofHeight(found, found.FromEnu(truth.origin))));
}

TEST(FindShape, SmallShed) {
  const Shape truth = Rectangle(4.0, 2.6, FlatPart(0, 1, 0, 1, 102.4), 5.0);
  const Shape found = Found(MakeCandidate(truth)).shape;
  ASSERT_EQ(found.parts.size(), 1U);
  EXPECT_EQ(found.parts[0].roof, RoofKind::kFlat);
  EXPECT_GT(OverlapOf(found, truth), 0.85);
}

TEST(FindShape, RoundBuildingIsTheLeastRectangle) {
  for (const double radius : {5.0, 7.0, 11.0}) {
    const MadeCandidate made = MakeRoundCandidate(radius, 8.0);
    EXPECT_LT(FindDirection(made.candidate, made.cloud).concentration, 0.5);
    const ShapeGuess guess = Found(made);
    EXPECT_FALSE(guess.manhattan);
    ExpectSound(guess.shape);
    ASSERT_EQ(guess.shape.parts.size(), 1U);
    EXPECT_NEAR(guess.shape.u.back() - guess.shape.u.front(), 2.0 * radius, 0.6);
    EXPECT_NEAR(guess.shape.v.back() - guess.shape.v.front(), 2.0 * radius, 0.6);
    EXPECT_NEAR(guess.shape.parts[0].eave_z, 108.0, 0.1);
  }
}

TEST(FindShape, NothingWithoutPointsOrGround) {
  const MadeCandidate made = MakeCandidate(Rectangle(8.0, 6.0, FlatPart(0, 1, 0, 1, 104.0)));
  const Direction direction = FindDirection(made.candidate, made.cloud);
  EXPECT_FALSE(FindShape(made.candidate, direction, made.cloud, kUnknown, kGsd_m));
  Candidate few = made.candidate;
  few.roof.resize(5);
  EXPECT_FALSE(FindShape(few, direction, made.cloud, 100.0, kGsd_m));
  Candidate elsewhere = made.candidate;
  for (Eigen::Vector2d& corner : elsewhere.outline.outer) corner += Eigen::Vector2d(500.0, 0.0);
  EXPECT_FALSE(FindShape(elsewhere, direction, made.cloud, 100.0, kGsd_m));
  elsewhere.outline.outer.clear();
  EXPECT_FALSE(FindShape(elsewhere, {}, made.cloud, 100.0, kGsd_m));
}

TEST(FindShape, PointsThatAreNotFiniteDoNoHarm) {
  const Shape truth = Rectangle(11.0, 8.0, PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 105.0, 109.0), 33.0);
  MadeCandidate made = MakeCandidate(truth);
  for (size_t i = 0; i < made.cloud.points.size(); i += 97) made.cloud.points[i].position.z() = std::nanf("");
  for (size_t i = 5; i < made.cloud.points.size(); i += 89) made.cloud.points[i].normal.x() = std::nanf("");
  const ShapeGuess guess = Found(made);
  ExpectSound(guess.shape);
  EXPECT_GT(OverlapOf(guess.shape, truth), 0.95);
}

// Any turn, size, noise and visibility: the walls, the number of parts and the roofs stay.
RC_GTEST_PROP(FindShape, TurnsWithTheBuilding, ()) {
  const auto seed = static_cast<uint64_t>(*rc::gen::inRange(1, 1000000));
  const double yaw_deg = 0.1 * *rc::gen::inRange(0, 3600);
  const double length = 0.1 * *rc::gen::inRange(90, 160), width = 0.1 * *rc::gen::inRange(80, 100);
  const double rise = 0.1 * *rc::gen::inRange(20, 50);
  Shape truth;
  switch (*rc::gen::inRange(0, 4)) {
    case 0:
      truth = Rectangle(length, width, PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 105.0, 105.0 + rise), yaw_deg);
      break;
    case 1:
      truth = Rectangle(length + 3.0, width, PitchedPart(RoofKind::kHip, 0, 1, 0, 1, true, 105.0, 105.0 + rise), yaw_deg);
      break;
    case 2:
      truth = AxesAt(yaw_deg, {0.0, width, width + length}, {-length, 0.0, width});
      truth.parts = {FlatPart(0, 2, 1, 2, 110.0), FlatPart(0, 1, 0, 1, 110.0 - rise)};
      break;
    default:
      truth = AxesAt(yaw_deg, {0.0, width, width + length}, {-length, 0.0, width});
      truth.parts = {PitchedPart(RoofKind::kGable, 0, 2, 1, 2, true, 105.0, 105.0 + rise),
                     PitchedPart(RoofKind::kGable, 0, 1, 0, 1, false, 105.0, 105.0 + rise, 0)};
  }
  const MadeCandidate made = MakeCandidate(truth, {.wall_share = 0.4, .seed = seed});
  const Direction direction = FindDirection(made.candidate, made.cloud);
  RC_ASSERT(std::abs(std::remainder(direction.yaw_rad - truth.yaw_rad, 0.5 * std::numbers::pi)) < 0.03);
  const std::optional<ShapeGuess> guess = FindShape(made.candidate, direction, made.cloud, 100.0, kGsd_m);
  RC_ASSERT(guess.has_value());
  RC_ASSERT(guess->shape.parts.size() == truth.parts.size());
  RC_ASSERT(OverlapOf(guess->shape, truth) > 0.9);
}

}  // namespace
}  // namespace skyquilt::buildings
