#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "buildings/fit/fit_parameters.h"
#include "buildings/fit/fit_shape.h"
#include "buildings/fit/roof_pieces.h"
#include "core/base/random.h"
#include "tests/buildings/fit/made_surface.h"

namespace skyquilt::buildings {
namespace {

FittedShape Exact(const Shape& shape) {
  FittedShape fitted;
  fitted.shape = shape;
  return fitted;
}

TEST(MeasureShape, GableIsExact) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 10, 13, 0.25);
  const Measures m = MeasureShape(Exact(shape), {});
  EXPECT_NEAR(m.length_m.value, 12.0, 1e-12);
  EXPECT_NEAR(m.width_m.value, 8.0, 1e-12);
  EXPECT_NEAR(m.ground_m.value, 4.0, 1e-12);
  EXPECT_NEAR(m.eave_m.value, 10.0, 1e-12);
  EXPECT_NEAR(m.ridge_m.value, 13.0, 1e-12);
  EXPECT_NEAR(m.height_m.value, 9.0, 1e-12);
  EXPECT_NEAR(m.yaw_deg.value, 0.25 * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(m.footprint_m2.value, 96.0, 1e-9);
  EXPECT_NEAR(m.roof_m2.value, 12.0 * 10.0, 1e-9);  // two slopes of 5 m
  EXPECT_NEAR(m.volume_m3.value, 96.0 * 6.0 + 0.5 * 96.0 * 3.0, 1e-9);
  EXPECT_NEAR(m.pitch_deg.value, std::atan2(3.0, 4.0) * 180 / std::numbers::pi, 1e-9);
  EXPECT_TRUE(std::isnan(m.length_m.sigma));  // no covariance
}

TEST(MeasureShape, HipIsExact) {
  const Measures m = MeasureShape(Exact(OnePart(RoofKind::kHip, 12, 8, 10, 13)), {});
  EXPECT_NEAR(m.roof_m2.value, 96.0 * 1.25, 1e-9);
  // A prism over the ridge, and a pyramid.
  EXPECT_NEAR(m.volume_m3.value, 96.0 * 6.0 + 0.5 * 3.0 * 8.0 * 4.0 + 8.0 * 8.0 * 3.0 / 3.0, 1e-9);
}

TEST(MeasureShape, LengthIsTheLongerSideAndYawItsDirection) {
  const Shape shape = OnePart(RoofKind::kFlat, 8, 12, 10, 10, 0.1);
  const Measures m = MeasureShape(Exact(shape), {});
  EXPECT_NEAR(m.length_m.value, 12.0, 1e-12);
  EXPECT_NEAR(m.yaw_deg.value, 90.0 + 0.1 * 180 / std::numbers::pi, 1e-9);
  EXPECT_EQ(m.pitch_deg.value, 0.0);
  Shape turned = shape;
  turned.yaw_rad -= 0.2 + 3.0 * std::numbers::pi;
  EXPECT_NEAR(MeasureShape(Exact(turned), {}).yaw_deg.value, 90.0 - 0.1 * 180 / std::numbers::pi, 1e-9);
}

TEST(RoofPieces, JoinedGablesAreExact) {
  Shape shape;
  shape.u = {0, 4, 8, 12};
  shape.v = {-5, 0, 8};
  shape.parts = {Part{.u0 = 0, .u1 = 3, .v0 = 1, .v1 = 2, .roof = RoofKind::kGable, .along_u = true, .eave_z = 5, .ridge_z = 8},
                 Part{.u0 = 1, .u1 = 2, .v0 = 0, .v1 = 1, .roof = RoofKind::kGable, .along_u = false, .eave_z = 5, .ridge_z = 7, .joins = 0}};
  const RoofTotals totals = TotalsOf(shape);
  // Above the eaves: both prisms, and the piece of the wing's prism that lies on the main roof: a pyramid of base 4 x 8/3, height 2.
  EXPECT_NEAR(totals.plan_m2, 96.0 + 20.0, 1e-9);
  EXPECT_NEAR(totals.volume_m3, 116.0 * 5.0 + 0.5 * 96.0 * 3.0 + 0.5 * 20.0 * 2.0 + 0.5 * 4.0 * 2.0 * (2.0 / 0.75) / 3.0, 1e-9);
}

Shape RandomShape() {
  const auto number = [](int low, int high) { return *rc::gen::inRange(low, high) / 10.0; };
  Shape shape;
  shape.u = {0.0, number(20, 60), 0.0, 0.0};
  shape.u[2] = shape.u[1] + number(20, 60);
  shape.u[3] = shape.u[2] + number(20, 60);
  shape.v = {0.0, number(20, 80), 0.0};
  shape.v[2] = shape.v[1] + number(20, 80);
  const int parts = *rc::gen::inRange(1, 4);
  for (int i = 0; i < parts; ++i) {
    Part part;
    part.u0 = *rc::gen::inRange(0, 3);
    part.u1 = *rc::gen::inRange(part.u0 + 1, 4);
    part.v0 = *rc::gen::inRange(0, 2);
    part.v1 = *rc::gen::inRange(part.v0 + 1, 3);
    part.roof = *rc::gen::element(RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip);
    part.along_u = *rc::gen::arbitrary<bool>();
    part.eave_z = number(30, 60);
    part.ridge_z = part.roof == RoofKind::kFlat ? part.eave_z : part.eave_z + number(10, 30);
    if (i > 0 && *rc::gen::arbitrary<bool>()) part.joins = 0;
    shape.parts.push_back(part);
  }
  return shape;
}

// Whether a place is inside a convex piece (1), outside (0) or too near its border to say (-1).
int IsInside(const RoofPiece& piece, const Eigen::Vector2d& uv) {
  double least = 1.0;
  for (size_t i = 0; i < piece.outline.size(); ++i) {
    const Eigen::Vector2d a = piece.outline[i], along = piece.outline[(i + 1) % piece.outline.size()] - a;
    if (along.norm() < 1e-7) continue;
    least = std::min(least, (along.x() * (uv.y() - a.y()) - along.y() * (uv.x() - a.x())) / along.norm());
  }
  return std::abs(least) < 1e-5 ? -1 : least > 0.0;
}

RC_GTEST_PROP(RoofPieces, CoverTheFootprintOnceAtTheHeightOfTheRoof, ()) {
  const Shape shape = RandomShape();
  const std::vector<RoofPiece> pieces = RoofPieces(shape);
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000));
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d uv{random.Uniform(-1.0, shape.u.back() + 1.0), random.Uniform(-1.0, shape.v.back() + 1.0)};
    const double height = RoofHeight(shape, uv);
    int covers = 0;
    bool on_border = false;
    for (const RoofPiece& piece : pieces) {
      const int inside = IsInside(piece, uv);
      on_border = on_border || inside < 0;
      if (inside != 1) continue;
      ++covers;
      RC_ASSERT(std::abs(piece.slope.dot(uv) + piece.offset - height) < 1e-9);
    }
    if (!on_border) RC_ASSERT(covers == (std::isnan(height) ? 0 : 1));
  }
}

RC_GTEST_PROP(RoofPieces, VolumeIsThatOfManyColumns, ()) {
  const Shape shape = RandomShape();
  constexpr double kCell_m = 0.1;  // all lines lie between cells
  double volume = 0.0;
  for (double u = 0.5 * kCell_m; u < shape.u.back(); u += kCell_m) {
    for (double v = 0.5 * kCell_m; v < shape.v.back(); v += kCell_m) {
      const double z = RoofHeight(shape, {u, v});
      if (!std::isnan(z)) volume += kCell_m * kCell_m * (z - shape.ground_z);
    }
  }
  RC_ASSERT(std::abs(TotalsOf(shape).volume_m3 - volume) < 0.01 * volume);
}

FittedShape WithSigmas(const Shape& shape, double line_m, double height_m) {
  FittedShape fitted = Exact(shape);
  const Parameters parameters(shape);
  const int n = parameters.shape_size() + 1;
  fitted.covariance = Eigen::MatrixXd::Zero(n, n);
  fitted.covariance(0, 0) = 1e-4;
  for (int i = 1; i < n; ++i) fitted.covariance(i, i) = std::pow(i <= 4 ? line_m : height_m, 2);
  return fitted;
}

TEST(MeasureShape, SigmasArePropagated) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 10, 13);
  FittedShape fitted = WithSigmas(shape, 0.1, 0.05);
  const Measures m = MeasureShape(fitted, {});
  EXPECT_NEAR(m.length_m.sigma, 0.1 * std::numbers::sqrt2, 1e-6);
  EXPECT_NEAR(m.ridge_m.sigma, 0.05, 1e-6);
  EXPECT_NEAR(m.height_m.sigma, 0.05 * std::numbers::sqrt2, 1e-6);
  EXPECT_NEAR(m.yaw_deg.sigma, 0.01 * 180 / std::numbers::pi, 1e-6);
  EXPECT_NEAR(m.footprint_m2.sigma, 0.1 * std::numbers::sqrt2 * std::hypot(12, 8), 1e-4);
  // d volume: width 12 x 7.5 per metre, length 8 x 7.5, eave and ridge half the footprint each, ground all of it.
  EXPECT_NEAR(m.volume_m3.sigma,
              std::sqrt(2 * std::pow(0.1 * 90, 2) + 2 * std::pow(0.1 * 60, 2) + 2 * std::pow(0.05 * 48, 2) + std::pow(0.05 * 96, 2)), 1e-3);
  // Lines that move together change no length.
  fitted.covariance(1, 2) = fitted.covariance(2, 1) = 0.01;
  EXPECT_NEAR(MeasureShape(fitted, {}).length_m.sigma, 0.0, 1e-6);
}

TEST(MeasureShape, PlaceAccuracyAddsWhatIsKnown) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 10, 13);
  const FittedShape fitted = WithSigmas(shape, 0.1, 0.05);
  const Measures alone = MeasureShape(fitted, {});
  FitOptions options;
  options.accuracy.scale_percent = 1.0;  // the others are unknown
  const Measures scaled = MeasureShape(fitted, options);
  EXPECT_NEAR(scaled.length_m.sigma, std::hypot(alone.length_m.sigma, 0.12), 1e-9);
  EXPECT_NEAR(scaled.roof_m2.sigma, std::hypot(alone.roof_m2.sigma, 0.02 * 120), 1e-9);
  EXPECT_NEAR(scaled.volume_m3.sigma, std::hypot(alone.volume_m3.sigma, 0.03 * 720), 1e-9);
  EXPECT_NEAR(scaled.height_m.sigma, std::hypot(alone.height_m.sigma, 0.09), 1e-9);
  EXPECT_EQ(scaled.ridge_m.sigma, alone.ridge_m.sigma);
  EXPECT_EQ(scaled.yaw_deg.sigma, alone.yaw_deg.sigma);
  options.accuracy = {};
  options.accuracy.vertical_m = 0.5;
  options.accuracy.yaw_deg = 2.0;
  options.accuracy.tilt_deg = 0.1;
  const Measures lifted = MeasureShape(fitted, options);
  const double lift = 0.1 * std::numbers::pi / 180 / std::numbers::sqrt2 * shape.origin.norm();
  for (const auto& [after, before] :
       {std::pair(lifted.ground_m, alone.ground_m), std::pair(lifted.eave_m, alone.eave_m), std::pair(lifted.ridge_m, alone.ridge_m)}) {
    EXPECT_NEAR(after.sigma, std::sqrt(before.sigma * before.sigma + 0.25 + lift * lift), 1e-9);
  }
  EXPECT_NEAR(lifted.height_m.sigma, alone.height_m.sigma, 1e-9);  // ridge and ground are at the same place
  EXPECT_NEAR(lifted.yaw_deg.sigma, std::hypot(alone.yaw_deg.sigma, 2.0), 1e-9);
  EXPECT_EQ(lifted.length_m.sigma, alone.length_m.sigma);
}

}  // namespace
}  // namespace skyquilt::buildings
