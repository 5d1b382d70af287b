#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "buildings/shape/find_shape.h"
#include "buildings/shape/right_angle.h"
#include "tests/buildings/shape/made_candidates.h"

namespace skyquilt::buildings {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Shape House(double yaw_deg) {
  Shape shape = AxesAt(yaw_deg, {-7.0, 7.0}, {-5.0, 5.0});
  shape.parts = {PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 105.0, 109.0)};
  return shape;
}

TEST(RightAngle, WrapsAtNinetyDegrees) {
  EXPECT_NEAR(RightAngleDifference(89.0 * kDegree, 1.0 * kDegree), -2.0 * kDegree, 1e-12);
  EXPECT_NEAR(InRightAngle(-1.0 * kDegree), 89.0 * kDegree, 1e-12);
  EXPECT_NEAR(InRightAngle(725.0 * kDegree), 5.0 * kDegree, 1e-12);
  EXPECT_EQ(InRightAngle(0.0), 0.0);
  EXPECT_GE(InRightAngle(-1e-18), 0.0);
  EXPECT_LT(InRightAngle(-1e-18), kRightAngle_rad);
}

RC_GTEST_PROP(FindDirection, FollowsTheBuilding, ()) {
  const double yaw_deg = 0.1 * *rc::gen::inRange(0, 3600);
  const MadeCandidate made = MakeCandidate(House(yaw_deg), {.seed = static_cast<uint64_t>(*rc::gen::inRange(1, 1000000))});
  const Direction found = FindDirection(made.candidate, made.cloud);
  RC_ASSERT(found.yaw_rad >= 0.0 && found.yaw_rad < kRightAngle_rad);
  RC_ASSERT(found.concentration > 0.8);
  RC_ASSERT(found.sigma_rad < 1.5 * kDegree);
  RC_ASSERT(std::abs(RightAngleDifference(found.yaw_rad, yaw_deg * kDegree)) < 4.0 * found.sigma_rad);
}

// The outline follows raster cells along east and north; that is no evidence for a building along them.
TEST(FindDirection, OutlineAloneIsNotThatOfItsRaster) {
  for (const double yaw_deg : {5.0, 20.0, 45.0, 70.0}) {
    Candidate outline_only = MakeCandidate(House(yaw_deg)).candidate;
    outline_only.planes.clear();
    outline_only.wall.clear();
    EXPECT_NEAR(RightAngleDifference(FindDirection(outline_only, {}).yaw_rad, yaw_deg * kDegree), 0.0, 1.5 * kDegree) << yaw_deg;
  }
}

TEST(FindDirection, StrayEvidenceDoesNotTurnIt) {
  MadeCandidate made = MakeCandidate(House(30.0));
  // A bush and a neighbour's wall at 50 degrees.
  const size_t stray = made.candidate.wall.size() / 4;
  for (size_t i = 0; i < stray; ++i) {
    made.cloud.points[made.candidate.wall[i]].normal = Eigen::Vector3d(std::cos(50.0 * kDegree), std::sin(50.0 * kDegree), 0.0).cast<float>();
  }
  EXPECT_NEAR(RightAngleDifference(FindDirection(made.candidate, made.cloud).yaw_rad, 30.0 * kDegree), 0.0, 1.5 * kDegree);
}

TEST(FindDirection, NothingIsKnownWithoutEvidence) {
  const Direction none = FindDirection({}, {});
  EXPECT_EQ(none.concentration, 0.0);
  EXPECT_EQ(none.sigma_rad, 1.0);
}

Direction At(double yaw_deg, double sigma_deg, double concentration = 0.9) {
  return {yaw_deg * kDegree, sigma_deg * kDegree, concentration};
}

TEST(ShareDirections, NeighboursThatAgreeBecomeOne) {
  const std::vector<Direction> own = {At(10.0, 1.0), At(11.0, 0.5), At(30.0, 1.0)};
  const std::vector<Eigen::Vector2d> places = {{0, 0}, {20, 0}, {10, 10}};
  const std::vector<Direction> shared = ShareDirections(own, places, 60.0);
  ASSERT_EQ(shared.size(), 3U);
  EXPECT_NEAR(shared[0].yaw_rad, 10.8 * kDegree, 1e-9);  // weights 1 and 4
  EXPECT_EQ(shared[0].yaw_rad, shared[1].yaw_rad);
  EXPECT_LT(shared[0].sigma_rad, own[1].sigma_rad);
  EXPECT_EQ(shared[2].yaw_rad, own[2].yaw_rad);
  EXPECT_EQ(shared[2].sigma_rad, own[2].sigma_rad);
}

TEST(ShareDirections, AcrossNinetyDegrees) {
  const std::vector<Direction> shared =
      ShareDirections(std::vector<Direction>{At(89.5, 1.0), At(0.5, 1.0)}, std::vector<Eigen::Vector2d>{{0, 0}, {5, 0}}, 60.0);
  EXPECT_NEAR(RightAngleDifference(shared[0].yaw_rad, 0.0), 0.0, 1e-9);
  EXPECT_EQ(shared[0].yaw_rad, shared[1].yaw_rad);
  EXPECT_GE(shared[0].yaw_rad, 0.0);
  EXPECT_LT(shared[0].yaw_rad, kRightAngle_rad);
}

TEST(ShareDirections, NotWithFarRoundOrNoNeighbours) {
  const std::vector<Eigen::Vector2d> places = {{0, 0}, {100, 0}};
  const std::vector<Direction> own = {At(10.0, 1.0), At(10.5, 1.0)};
  EXPECT_EQ(ShareDirections(own, places, 60.0)[0].yaw_rad, own[0].yaw_rad);
  EXPECT_NE(ShareDirections(own, places, 150.0)[0].yaw_rad, own[0].yaw_rad);
  EXPECT_EQ(ShareDirections(own, places, 0.0)[0].yaw_rad, own[0].yaw_rad);
  const std::vector<Direction> with_round = {At(10.0, 1.0), At(10.5, 1.0, 0.3)};
  EXPECT_EQ(ShareDirections(with_round, places, 150.0)[0].yaw_rad, with_round[0].yaw_rad);
  EXPECT_EQ(ShareDirections(with_round, places, 150.0)[1].yaw_rad, with_round[1].yaw_rad);
  EXPECT_TRUE(ShareDirections({}, {}, 60.0).empty());
}

// A street that bends slowly must not become straight: the group's own sigma shrinks, so that its ends stay apart.
TEST(ShareDirections, ABendIsNoChain) {
  std::vector<Direction> own;
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < 30; ++i) {
    own.push_back(At(10.0 + i, 0.7));
    places.emplace_back(15.0 * i, 0.0);
  }
  const std::vector<Direction> shared = ShareDirections(own, places, 60.0);
  for (size_t i = 0; i < own.size(); ++i) EXPECT_NEAR(shared[i].yaw_rad, own[i].yaw_rad, 3.0 * kDegree) << i;
  EXPECT_GT(shared.back().yaw_rad - shared.front().yaw_rad, 25.0 * kDegree);
}

}  // namespace
}  // namespace skyquilt::buildings
