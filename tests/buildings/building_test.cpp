#include "buildings/building.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "buildings/buildings_options.h"
#include "core/base/errors.h"
#include "tests/support/error_of.h"

namespace skyquilt::buildings {
namespace {

Shape House(RoofKind roof, double length, double width, double eave_z = 5.0, double ridge_z = 8.0) {
  Shape shape;
  shape.origin = {100.0, -50.0};
  shape.yaw_rad = 0.4;
  shape.u = {-1.0, length - 1.0};
  shape.v = {2.0, width + 2.0};
  Part part;
  part.roof = roof;
  part.along_u = length >= width;
  part.eave_z = eave_z;
  part.ridge_z = roof == RoofKind::kFlat || roof == RoofKind::kOther ? eave_z : ridge_z;
  shape.parts = {part};
  return shape;
}

// A main gable along u over v 0 to 8 and a lower wing along v to its south, whose ridge runs into the main roof.
Shape THouse(double wing_ridge_z = 7.0) {
  Shape shape;
  shape.u = {0.0, 4.0, 8.0, 12.0};
  shape.v = {-5.0, 0.0, 8.0};
  Part main{.u0 = 0, .u1 = 3, .v0 = 1, .v1 = 2, .roof = RoofKind::kGable, .along_u = true, .eave_z = 5.0, .ridge_z = 8.0};
  Part wing{.u0 = 1, .u1 = 2, .v0 = 0, .v1 = 1, .roof = RoofKind::kGable, .along_u = false, .eave_z = 5.0, .ridge_z = wing_ridge_z, .joins = 0};
  shape.parts = {main, wing};
  return shape;
}

TEST(RoofKind, NamesComeBack) {
  for (const RoofKind roof : {RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip, RoofKind::kOther}) EXPECT_EQ(RoofNamed(NameOf(roof)), roof);
  EXPECT_THROW(RoofNamed("Flat"), base::UsageError);
  EXPECT_THROW(RoofNamed(""), base::UsageError);
}

RC_GTEST_PROP(Shape, AxesAreARightHandedTurn, ()) {
  Shape shape = House(RoofKind::kFlat, 10, 8);
  shape.yaw_rad = *rc::gen::inRange(-700, 700) / 100.0;
  const Eigen::Vector2d uv(*rc::gen::inRange(-500, 500) / 10.0, *rc::gen::inRange(-500, 500) / 10.0);
  RC_ASSERT((shape.FromEnu(shape.EnuFrom(uv)) - uv).norm() < 1e-9);
  const Eigen::Vector2d u = shape.AxisU(), v = shape.AxisV();
  RC_ASSERT(std::abs(u.x() * v.y() - u.y() * v.x() - 1.0) < 1e-12);
}

TEST(Shape, UIsYawFromEast) {
  Shape shape = House(RoofKind::kFlat, 10, 8);
  shape.yaw_rad = 0.5 * std::numbers::pi;
  EXPECT_NEAR(shape.EnuFrom({3.0, 0.0}).x(), 100.0, 1e-12);
  EXPECT_NEAR(shape.EnuFrom({3.0, 0.0}).y(), -47.0, 1e-12);
}

TEST(RoofHeight, GableIsEaveAtWallsAndRidgeInTheMiddle) {
  const Shape shape = House(RoofKind::kGable, 12, 8);
  const Part& part = shape.parts[0];
  for (const double u : {-1.0, 3.0, 11.0}) {
    EXPECT_NEAR(RoofHeight(shape, part, {u, 2.0}), 5.0, 1e-12);
    EXPECT_NEAR(RoofHeight(shape, part, {u, 10.0}), 5.0, 1e-12);
    EXPECT_NEAR(RoofHeight(shape, part, {u, 6.0}), 8.0, 1e-12);
  }
  EXPECT_NEAR(RoofHeight(shape, part, {3.0, 1.6}), 5.0 - 0.4 * 0.75, 1e-12);  // the overhang falls on
  EXPECT_NEAR(RoofHeight(shape, part, {20.0, 4.0}), 6.5, 1e-12);
}

TEST(RoofHeight, GableAcross) {
  Shape shape = House(RoofKind::kGable, 12, 8);
  shape.parts[0].along_u = false;
  EXPECT_NEAR(RoofHeight(shape, {5.0, 2.5}), 8.0, 1e-12);
  EXPECT_NEAR(RoofHeight(shape, {-1.0, 2.5}), 5.0, 1e-12);
}

TEST(RoofHeight, HipHasEqualPitchesAndAShorterRidge) {
  const Shape shape = House(RoofKind::kHip, 12, 8);
  const Part& part = shape.parts[0];
  const double pitch = 3.0 / 4.0;
  for (const Eigen::Vector2d& wall : {Eigen::Vector2d(-1, 6), Eigen::Vector2d(11, 6), Eigen::Vector2d(5, 2), Eigen::Vector2d(5, 10)}) {
    EXPECT_NEAR(RoofHeight(shape, part, wall), 5.0, 1e-12);
    const Eigen::Vector2d in = (Eigen::Vector2d(5, 6) - wall).normalized();
    EXPECT_NEAR(RoofHeight(shape, part, wall + in) - RoofHeight(shape, part, wall), pitch, 1e-12);
  }
  EXPECT_NEAR(RoofHeight(shape, part, {3.0, 6.0}), 8.0, 1e-12);  // ends of the ridge
  EXPECT_NEAR(RoofHeight(shape, part, {7.0, 6.0}), 8.0, 1e-12);
  EXPECT_LT(RoofHeight(shape, part, {2.9, 6.0}), 8.0);
}

RC_GTEST_PROP(RoofHeight, HipIsContinuousAndNeverAboveTheGable, ()) {
  const Shape hip = House(RoofKind::kHip, *rc::gen::inRange(40, 300) / 10.0, *rc::gen::inRange(40, 300) / 10.0);
  Shape gable = hip;
  gable.parts[0].roof = RoofKind::kGable;
  const Eigen::Vector2d size = hip.MaxOf(hip.parts[0], false) - hip.MinOf(hip.parts[0], false);
  const double pitch = 3.0 / (0.5 * size.minCoeff());
  const Eigen::Vector2d a(*rc::gen::inRange(-50, 350) / 10.0, *rc::gen::inRange(-50, 350) / 10.0);
  const Eigen::Vector2d b = a + Eigen::Vector2d(*rc::gen::inRange(-20, 20), *rc::gen::inRange(-20, 20)) / 10.0;
  const double step = RoofHeight(hip, hip.parts[0], a) - RoofHeight(hip, hip.parts[0], b);
  RC_ASSERT(std::abs(step) <= pitch * (a - b).norm() + 1e-9);
  RC_ASSERT(RoofHeight(hip, hip.parts[0], a) <= RoofHeight(gable, gable.parts[0], a) + 1e-9);
  RC_ASSERT(RoofHeight(hip, hip.parts[0], a) <= 8.0 + 1e-9);
}

TEST(RoofHeight, SquareHipIsAPyramid) {
  const Shape shape = House(RoofKind::kHip, 8, 8);
  EXPECT_NEAR(RoofHeight(shape, {3.0, 6.0}), 8.0, 1e-12);
  EXPECT_LT(RoofHeight(shape, {3.1, 6.0}), 8.0);
  EXPECT_LT(RoofHeight(shape, {3.0, 6.1}), 8.0);
}

TEST(RoofHeight, IsTheHighestPartAndNothingOutside) {
  Shape shape;
  shape.u = {0, 4, 8, 12};
  shape.v = {0, 3, 6, 9};
  shape.parts = {Part{.u0 = 0, .u1 = 3, .v0 = 0, .v1 = 3, .eave_z = 6, .ridge_z = 6},
                 Part{.u0 = 1, .u1 = 2, .v0 = 1, .v1 = 2, .eave_z = 15, .ridge_z = 15}};
  int part = -7;
  EXPECT_EQ(RoofHeight(shape, {6, 4}, &part), 15.0);
  EXPECT_EQ(part, 1);
  EXPECT_EQ(RoofHeight(shape, {1, 1}, &part), 6.0);
  EXPECT_EQ(part, 0);
  EXPECT_TRUE(std::isnan(RoofHeight(shape, {12.1, 1}, &part)));
  EXPECT_EQ(part, -1);
}

TEST(RoofHeight, JoinedRidgeRunsToTheMiddleOfItsHost) {
  const Shape shape = THouse();
  EXPECT_EQ(shape.MaxOf(shape.parts[1], false).y(), 0.0);
  EXPECT_EQ(shape.MaxOf(shape.parts[1], true).y(), 4.0);
  EXPECT_EQ(shape.MinOf(shape.parts[1], true).y(), -5.0);
  int part = -1;
  EXPECT_NEAR(RoofHeight(shape, {6.0, 1.0}, &part), 7.0, 1e-12);  // the main roof is at 5.75 there
  EXPECT_EQ(part, 1);
  EXPECT_NEAR(RoofHeight(shape, {6.0, 3.0}, &part), 7.25, 1e-12);
  EXPECT_EQ(part, 0);
  EXPECT_NEAR(RoofHeight(shape, {2.0, 1.0}, &part), 5.75, 1e-12);
  // To the other side too, and not for roofs that join nothing.
  Shape north = shape;
  north.v = {0.0, 8.0, 13.0};
  north.parts[0].v0 = 0, north.parts[0].v1 = 1, north.parts[1].v0 = 1, north.parts[1].v1 = 2;
  EXPECT_EQ(north.MinOf(north.parts[1], true).y(), 4.0);
  north.parts[1].joins = -1;
  EXPECT_EQ(north.MinOf(north.parts[1], true).y(), 8.0);
  north.parts[1].joins = 1;  // itself
  EXPECT_EQ(north.MinOf(north.parts[1], true).y(), 8.0);
}

TEST(RoofHeight, JoinedRoofHasNoPlaceOutsideAllWalls) {
  Shape shape = THouse();
  shape.parts[0].u1 = 1;  // the host ends where the wing begins
  EXPECT_TRUE(std::isnan(RoofHeight(shape, {6.0, 1.0})));
  EXPECT_FALSE(std::isnan(RoofHeight(shape, {6.0, -1.0})));
}

TEST(BuildingsOptions, DefaultsAreAllowedAndFieldsAreNamedOnce) {
  EXPECT_NO_THROW(BuildingsOptions().Check());
  std::vector<std::string> keys;
  for (const auto& field : BuildingsOptions::Fields()) keys.push_back(field.key);
  EXPECT_EQ(keys.size(), 14U);
  std::sort(keys.begin(), keys.end());
  EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
}

TEST(BuildingsOptions, ScaleBarIsTwoPlacesAndADistance) {
  BuildingsOptions options;
  options.scale_bar = {0, 0, 0, 1, 0, 0, 2.5};
  EXPECT_NO_THROW(options.Check());
  for (const std::vector<double>& bad : {std::vector<double>{0, 0, 0, 1, 0, 0},
                                         {0, 0, 0, 1, 0, 0, 0},
                                         {0, 0, 0, 1, 0, 0, -2},
                                         {3, 4, 5, 3, 4, 5, 2},
                                         {0, 0, 0, 1e-200, 0, 0, 1},
                                         {0, 0, 0, 1e-9, 0, 0, 1},
                                         {0, 0, 0, 1e9, 0, 0, 1}}) {
    options.scale_bar = bad;
    EXPECT_THROW(options.Check(), base::UsageError) << bad.size();
  }
  options.scale_bar = {0, 0, std::nan(""), 1, 0, 0, 2.5};
  EXPECT_THROW(options.Check(), base::UsageError);
}

TEST(BuildingsOptions, MessagesNameTheOption) {
  BuildingsOptions options;
  options.min_area_m2 = -1.0;
  const std::string error = UsageErrorOf([&] { options.Check(); });
  EXPECT_NE(error.find("buildings.min_area_m2"), std::string::npos) << error;
}

}  // namespace
}  // namespace skyquilt::buildings
