#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "buildings/fit/fit_shape.h"
#include "buildings/fit/wall_groups.h"
#include "buildings/fit/wall_strips.h"
#include "tests/buildings/fit/made_surface.h"

namespace skyquilt::buildings {
namespace {

double Length(const std::vector<WallPiece>& pieces, bool outer) {
  double length = 0.0;
  for (const WallPiece& piece : pieces) length += piece.outer == outer ? piece.to - piece.from : 0.0;
  return length;
}

TEST(WallPieces, GoAroundARectangle) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 10, 13);
  const std::vector<WallPiece> pieces = WallPieces(shape, 1.0);
  EXPECT_EQ(pieces.size(), 4U);
  EXPECT_NEAR(Length(pieces, true), 40.0, 1e-12);
  for (const WallPiece& piece : pieces) {
    EXPECT_LT(InFront(shape, piece, {0, 0}), 0.0);
    const WallHeights heights = HeightsAt(shape, piece, 0.0);
    EXPECT_EQ(heights.bottom, shape.ground_z);
    EXPECT_NEAR(heights.top, piece.axis == 0 ? 13.0 : 10.0, 1e-9);  // gable ends rise to the ridge
  }
}

TEST(WallPieces, OfATowerStandOnTheLowerRoof) {
  Shape shape;
  shape.u = {0, 5, 16};
  shape.v = {0, 8, 17};
  shape.parts = {Part{.u0 = 0, .u1 = 2, .v0 = 0, .v1 = 2, .eave_z = 9, .ridge_z = 9},
                 Part{.u0 = 1, .u1 = 2, .v0 = 1, .v1 = 2, .eave_z = 18, .ridge_z = 18}};
  const std::vector<WallPiece> pieces = WallPieces(shape, 1.0);
  EXPECT_NEAR(Length(pieces, true), 66.0, 1e-12);
  EXPECT_NEAR(Length(pieces, false), 9.0 + 11.0, 1e-12);
  for (const WallPiece& piece : pieces) {
    if (!piece.outer) {
      EXPECT_EQ(HeightsAt(shape, piece, 0.5 * (piece.from + piece.to)).bottom, 9.0);
    }
  }
}

TEST(WallPieces, NoneInsideAJoinedWing) {
  Shape shape;
  shape.u = {0, 4, 8, 12};
  shape.v = {-5, 0, 8};
  shape.parts = {Part{.u0 = 0, .u1 = 3, .v0 = 1, .v1 = 2, .roof = RoofKind::kGable, .along_u = true, .eave_z = 5, .ridge_z = 8},
                 Part{.u0 = 1, .u1 = 2, .v0 = 0, .v1 = 1, .roof = RoofKind::kGable, .along_u = false, .eave_z = 5, .ridge_z = 7, .joins = 0}};
  EXPECT_NEAR(Length(WallPieces(shape, 1.0), true), 2 * (12.0 + 8.0) + 2 * 5.0, 1e-12);
  EXPECT_EQ(Length(WallPieces(shape, 1.0), false), 0.0);
}

TEST(SetBack, GrowsWhereFewViewsSawTheWall) {
  double before = SetBack_gsd(0.0, 20.0);
  for (double views = 1.0; views <= 30.0; ++views) {
    const double now = SetBack_gsd(views, 20.0);
    EXPECT_LE(now, before);
    EXPECT_GE(now, 0.0);
    before = now;
  }
  EXPECT_EQ(SetBack_gsd(5.0, 0.0), 0.0);
}

TEST(ShareOfWallSeen, CountsPiecesWithPoints) {
  const Shape shape = OnePart(RoofKind::kFlat, 12, 8, 10, 10);
  MadeSurface made = SurfaceOf(shape);
  EXPECT_GT(ShareOfWallSeen(shape, made.candidate, made.cloud, 0.1), 0.97);
  // Only the walls of 12 m.
  Candidate some = made.candidate;
  std::erase_if(some.wall, [&](uint32_t i) { return std::abs(made.cloud.points[i].normal.y()) < 0.5F; });
  EXPECT_NEAR(ShareOfWallSeen(shape, some, made.cloud, 0.1), 24.0 / 40.0, 0.03);
  // Of those only the lower half.
  std::erase_if(some.wall, [&](uint32_t i) { return made.cloud.At(i).z() > 7.0; });
  EXPECT_NEAR(ShareOfWallSeen(shape, some, made.cloud, 0.1), 12.0 / 40.0, 0.06);
}

TEST(ShareOfWallSeen, TwoViewsAreNotEnoughAndFarPointsDoNotCount) {
  const Shape shape = OnePart(RoofKind::kFlat, 12, 8, 10, 10);
  SurfacePlan plan;
  plan.wall_views = 2;
  const MadeSurface doubtful = SurfaceOf(shape, plan);
  EXPECT_EQ(ShareOfWallSeen(shape, doubtful.candidate, doubtful.cloud, 0.1), 0.0);
  const MadeSurface made = SurfaceOf(shape);
  Shape wider = shape;
  wider.u = {-6.6, 6.6};
  wider.v = {-4.6, 4.6};
  EXPECT_LT(ShareOfWallSeen(wider, made.candidate, made.cloud, 0.1), 0.02);
}

// A stretch seen by many views counts more than one that few views saw.
TEST(WallGroups, TrustViews) {
  const Shape shape = OnePart(RoofKind::kFlat, 12, 8, 10, 10);
  MadeSurface made = SurfaceOf(shape);
  for (const uint32_t i : made.candidate.wall) made.cloud.points[i].views = made.cloud.At(i).z() > 7.0 ? 20 : 5;
  const FitPoints points = PointsFor(shape, made.candidate, made.cloud);
  const std::vector<Group> groups = WallGroups(points, shape, Parameters(shape), {0.1, 0.0, 1.0});
  ASSERT_EQ(groups.size(), 4U);
  for (const Group& group : groups) {
    double least = 1.0, most = 0.0;
    for (const Observation& o : group.observations) {
      least = std::min(least, o.trust);
      most = std::max(most, o.trust);
    }
    EXPECT_EQ(most, 1.0);
    EXPECT_LT(least, 0.3);
  }
}

}  // namespace
}  // namespace skyquilt::buildings
