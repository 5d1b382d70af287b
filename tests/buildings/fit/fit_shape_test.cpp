#include "buildings/fit/fit_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "tests/buildings/fit/made_surface.h"

namespace skyquilt::buildings {
namespace {

constexpr double kDegree = 3.14159265358979 / 180.0;

FitOptions Options(double gsd_m = 0.1) {
  FitOptions options;
  options.gsd_m = gsd_m;
  options.default_overhang_m = 0.4;
  return options;
}

// Largest errors of lines and heights.
struct Errors {
  double line = 0.0, height = 0.0;
};
Errors ErrorsOf(const Shape& fitted, const Shape& truth) {
  Errors errors;
  for (size_t i = 0; i < truth.u.size(); ++i) errors.line = std::max(errors.line, std::abs(fitted.u[i] - truth.u[i]));
  for (size_t i = 0; i < truth.v.size(); ++i) errors.line = std::max(errors.line, std::abs(fitted.v[i] - truth.v[i]));
  for (size_t p = 0; p < truth.parts.size(); ++p) {
    errors.height = std::max(
        {errors.height, std::abs(fitted.parts[p].eave_z - truth.parts[p].eave_z), std::abs(fitted.parts[p].ridge_z - truth.parts[p].ridge_z)});
  }
  return errors;
}

bool IsUsable(const Eigen::MatrixXd& covariance) {
  return covariance.allFinite() && (covariance.diagonal().array() > 0.0).all() && covariance.isApprox(covariance.transpose());
}

struct RoofCase {
  std::string name;
  Shape shape;
};
std::vector<RoofCase> Cases() {
  std::vector<RoofCase> cases = {{"flat", OnePart(RoofKind::kFlat, 14, 10, 10, 10, 0.5)},
                                 {"gable", OnePart(RoofKind::kGable, 12, 8, 10, 13, -0.3)},
                                 {"gable across", OnePart(RoofKind::kGable, 9, 11, 10, 12.5, 1.0)},
                                 {"hip", OnePart(RoofKind::kHip, 13, 9, 10, 13, 2.2)},
                                 {"square hip", OnePart(RoofKind::kHip, 10, 10, 10, 13, 0.1)}};
  Shape wings;
  wings.origin = {5, 5};
  wings.yaw_rad = 0.2;
  wings.u = {0, 5, 11, 16};
  wings.v = {-6, 0, 9};
  wings.ground_z = 4.0;
  wings.parts = {Part{.u0 = 0, .u1 = 3, .v0 = 1, .v1 = 2, .roof = RoofKind::kGable, .along_u = true, .eave_z = 10, .ridge_z = 13.5},
                 Part{.u0 = 1, .u1 = 2, .v0 = 0, .v1 = 1, .roof = RoofKind::kGable, .along_u = false, .eave_z = 10, .ridge_z = 12.5, .joins = 0}};
  cases.push_back({"T of gables", wings});
  Shape tower = wings;
  tower.u = {0, 5, 16};
  tower.v = {-8, 0, 9};
  tower.parts = {Part{.u0 = 0, .u1 = 2, .v0 = 0, .v1 = 2, .eave_z = 9, .ridge_z = 9},
                 Part{.u0 = 1, .u1 = 2, .v0 = 1, .v1 = 2, .eave_z = 18, .ridge_z = 18}};
  cases.push_back({"tower on a podium", tower});
  return cases;
}

TEST(FitShape, FindsMadeShapesAgain) {
  for (const RoofCase& one : Cases()) {
    for (const uint64_t seed : {uint64_t{1}, uint64_t{2}}) {
      SurfacePlan plan;
      plan.seed = seed;
      plan.spacing_m = 0.35;
      plan.parapet_m = 0.5;
      const MadeSurface made = SurfaceOf(one.shape, plan);
      const FittedShape fitted = FitShape(Disturbed(one.shape, 0.5, 0.4, 3.0 * kDegree, seed), made.candidate, made.cloud, Options());
      EXPECT_TRUE(fitted.converged) << one.name;
      const Errors errors = ErrorsOf(fitted.shape, one.shape);
      EXPECT_LT(errors.line, 0.05) << one.name << " seed " << seed;
      EXPECT_LT(errors.height, 0.05) << one.name << " seed " << seed;
      EXPECT_NEAR(fitted.shape.yaw_rad, one.shape.yaw_rad, 0.2 * kDegree) << one.name;
      EXPECT_NEAR(fitted.shape.ground_z, one.shape.ground_z, 0.03) << one.name;
      EXPECT_GT(fitted.share_within, 0.9) << one.name;
      EXPECT_LT(fitted.residual_m, 0.12) << one.name;
      EXPECT_EQ(
          fitted.covariance.rows(), 2 + static_cast<int>(one.shape.u.size() + one.shape.v.size()) + [&] {
            int n = 0;
            for (const Part& part : one.shape.parts) n += part.roof == RoofKind::kFlat ? 1 : 2;
            return n;
          }());
      EXPECT_TRUE(IsUsable(fitted.covariance)) << one.name;
      if (one.shape.parts[0].roof != RoofKind::kFlat) {
        EXPECT_NEAR(fitted.overhang_m, 0.4, 0.06) << one.name;
      }
      for (const bool seen : fitted.u_seen) EXPECT_TRUE(seen) << one.name;
    }
  }
}

TEST(FitShape, FlatRoofsHaveNoOverhang) {
  const Shape shape = OnePart(RoofKind::kFlat, 14, 10, 10, 10);
  const MadeSurface made = SurfaceOf(shape);
  EXPECT_TRUE(std::isnan(FitShape(shape, made.candidate, made.cloud, Options()).overhang_m));
}

TEST(FitShape, SameInputGivesTheSameBits) {
  const Shape shape = OnePart(RoofKind::kHip, 13, 9, 10, 13, 0.4);
  const MadeSurface made = SurfaceOf(shape);
  const Shape guess = Disturbed(shape, 0.4, 0.3, 0.03, 1);
  const FittedShape a = FitShape(guess, made.candidate, made.cloud, Options()), b = FitShape(guess, made.candidate, made.cloud, Options());
  EXPECT_EQ(a.shape.u, b.shape.u);
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(FitShape, DeckIsNotMovedByParapetsAndBoxes) {
  const Shape shape = OnePart(RoofKind::kFlat, 16, 12, 10, 10);
  SurfacePlan plan;
  plan.parapet_m = 0.8;
  MadeSurface made = SurfaceOf(shape, plan);
  for (const uint32_t i : made.candidate.roof) {
    const Eigen::Vector2d uv = shape.FromEnu(made.cloud.At(i).head<2>());
    if (std::abs(uv.x() - 3.0) < 1.7 && std::abs(uv.y() - 2.0) < 1.5) made.cloud.points[i].position.z() = 12.4F;
    if (std::abs(uv.x() + 4.0) < 1.0 && std::abs(uv.y() + 2.0) < 0.7) made.cloud.points[i].position.z() = 10.7F;
  }
  const FittedShape fitted = FitShape(Disturbed(shape, 0.3, 0.5, 0.03, 4), made.candidate, made.cloud, Options());
  EXPECT_NEAR(fitted.shape.parts[0].eave_z, 10.0, 0.02);
}

// Without walls, they stand inside the roof's edge by the assumed overhang, and are as uncertain as it is.
TEST(FitShape, WithoutWallsTheRoofsEdgeCounts) {
  for (const RoofKind roof : {RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip}) {
    const Shape shape = OnePart(roof, 13, 9, 10, roof == RoofKind::kFlat ? 10 : 13, 0.3);
    SurfacePlan plan;
    plan.walls = false;
    const MadeSurface made = SurfaceOf(shape, plan);
    FitOptions options = Options();
    const FittedShape fitted = FitShape(Disturbed(shape, 0.3, 0.3, 0.03, 2), made.candidate, made.cloud, options);
    const double length = fitted.shape.u[1] - fitted.shape.u[0], width = fitted.shape.v[1] - fitted.shape.v[0];
    EXPECT_NEAR(length, 13.0, 0.25) << NameOf(roof);
    EXPECT_NEAR(width, 9.0, 0.25) << NameOf(roof);
    EXPECT_EQ(fitted.wall_points, 0);
    EXPECT_FALSE(fitted.u_seen[0] || fitted.u_seen[1] || fitted.v_seen[0] || fitted.v_seen[1]);
    EXPECT_TRUE(std::isnan(fitted.overhang_m));
    const double sigma = MeasureShape(fitted, options).width_m.sigma;
    if (roof == RoofKind::kFlat) {
      EXPECT_LT(sigma, 0.3);
      continue;
    }
    EXPECT_GT(sigma, 1.5 * options.overhang_sigma_m) << NameOf(roof);  // on both sides
    options.default_overhang_m = 0.0;
    const FittedShape wider = FitShape(fitted.shape, made.candidate, made.cloud, options);
    EXPECT_NEAR(wider.shape.v[1] - wider.shape.v[0], width + 0.8, 0.1) << NameOf(roof);
  }
}

// Eaves of 3 m: the surface goes from the rim to the ground and shows no wall.
TEST(FitShape, LowWallsUnderOverhangsAreNotBelieved) {
  Shape shape = OnePart(RoofKind::kHip, 10, 9, 3, 5.5);
  shape.ground_z = 0.0;
  SurfacePlan plan;
  plan.gsd_m = 0.2;
  const MadeSurface made = SurfaceOf(shape, plan);
  const FittedShape fitted = FitShape(shape, made.candidate, made.cloud, Options(0.2));
  EXPECT_EQ(fitted.wall_points, 0);
  EXPECT_NEAR(fitted.shape.u[1] - fitted.shape.u[0], 10.0, 0.15);
}

TEST(FitShape, WallsSeenUnderTheOverhangAreNoRims) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 10, 13, 0.3);
  SurfacePlan plan;
  plan.under = true;
  const MadeSurface made = SurfaceOf(shape, plan);
  const FittedShape fitted = FitShape(Disturbed(shape, 0.3, 0.3, 0.03, 5), made.candidate, made.cloud, Options());
  EXPECT_NEAR(fitted.overhang_m, 0.4, 0.1);
  EXPECT_LT(ErrorsOf(fitted.shape, shape).line, 0.08);
}

TEST(FitShape, TreesBeforeAWallDoNotMoveIt) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 10, 13);
  MadeSurface made = SurfaceOf(shape);
  base::Random random(6);
  for (int i = 0; i < 400; ++i) {
    SurfacePoint point;
    point.position = Eigen::Vector3d{random.Uniform(-3, 4), -4.0 - random.Uniform(0.3, 1.5), random.Uniform(5, 8.5)}.cast<float>();
    point.normal = Eigen::Vector3f(0, -1, 0);
    point.views = 12;
    made.candidate.wall.push_back(static_cast<uint32_t>(made.cloud.points.size()));
    made.cloud.points.push_back(point);
  }
  const FittedShape fitted = FitShape(Disturbed(shape, 0.3, 0.3, 0.03, 3), made.candidate, made.cloud, Options());
  EXPECT_LT(ErrorsOf(fitted.shape, shape).line, 0.06);
}

TEST(FitShape, OtherRoofsAreBlocksUpToTheirMedian) {
  Shape shape = OnePart(RoofKind::kOther, 10, 8, 10, 10);
  MadeSurface made = SurfaceOf(shape);
  for (const uint32_t i : made.candidate.roof) made.cloud.points[i].position.z() += 0.02F * static_cast<float>(i % 11);
  const FittedShape fitted = FitShape(Disturbed(shape, 0.2, 0.5, 0.01, 1), made.candidate, made.cloud, Options());
  EXPECT_NEAR(fitted.shape.parts[0].eave_z, 10.1, 0.05);
  EXPECT_EQ(fitted.shape.parts[0].eave_z, fitted.shape.parts[0].ridge_z);
}

TEST(FitShape, TooFewPointsGiveTheGuess) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 10, 13);
  MadeSurface made = SurfaceOf(shape);
  made.candidate.roof.resize(5);
  made.candidate.wall.clear();
  made.candidate.ground.clear();
  for (int few = 0; few < 2; ++few) {
    const FittedShape fitted = FitShape(shape, made.candidate, made.cloud, Options());
    EXPECT_FALSE(fitted.converged);
    EXPECT_EQ(fitted.shape.u, shape.u);
    EXPECT_EQ(fitted.shape.ground_z, shape.ground_z);
    EXPECT_TRUE(IsUsable(fitted.covariance));
    const Measures measures = MeasureShape(fitted, Options());
    EXPECT_GT(measures.length_m.sigma, 0.5);
    EXPECT_TRUE(std::isfinite(measures.volume_m3.sigma) && std::isfinite(fitted.share_within) && std::isfinite(fitted.residual_m));
    made.candidate.roof.clear();
  }
}

// A guess far away, of the wrong kind or thin: any result, but finite.
TEST(FitShape, BadGuessesGiveFiniteFigures) {
  const Shape shape = OnePart(RoofKind::kGable, 12, 8, 10, 13);
  const MadeSurface made = SurfaceOf(shape);
  std::vector<Shape> guesses(4, shape);
  guesses[0].origin += Eigen::Vector2d(9, 0);
  guesses[1].parts[0].roof = RoofKind::kFlat;
  guesses[1].parts[0].ridge_z = guesses[1].parts[0].eave_z;
  guesses[2].v = {-0.2, 0.2};
  guesses[3].parts[0].eave_z = 30.0;
  for (const Shape& guess : guesses) {
    const FittedShape fitted = FitShape(guess, made.candidate, made.cloud, Options());
    EXPECT_TRUE(IsUsable(fitted.covariance));
    EXPECT_LT(fitted.shape.u[0], fitted.shape.u[1]);
    EXPECT_LT(fitted.shape.v[0], fitted.shape.v[1]);
    EXPECT_TRUE(std::isfinite(fitted.shape.parts[0].eave_z) && std::isfinite(fitted.shape.yaw_rad));
  }
}

// Of whole fits: common errors are allowed for that made surfaces do not have, so that more than 95 % are within.
TEST(FitShape, SigmasAreNotTooSmall) {
  const Shape shape = OnePart(RoofKind::kGable, 11, 8, 10, 12.5, 0.4);
  int within = 0, all = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    SurfacePlan plan;
    plan.seed = seed;
    plan.spacing_m = 0.5;
    plan.waves_m = 0.1;
    const MadeSurface made = SurfaceOf(shape, plan);
    const Measures measures = MeasureShape(FitShape(Disturbed(shape, 0.3, 0.2, 0.03, seed), made.candidate, made.cloud, Options()), Options());
    for (const auto& [measure, truth] : {std::pair(measures.length_m, 11.0), std::pair(measures.width_m, 8.0), std::pair(measures.eave_m, 10.0),
                                         std::pair(measures.ridge_m, 12.5), std::pair(measures.yaw_deg, 0.4 / kDegree)}) {
      ++all;
      if (std::abs(measure.value - truth) < 1.96 * measure.sigma) ++within;
      EXPECT_LT(measure.sigma, 1.0);
    }
  }
  EXPECT_GE(within, 0.88 * all);
}

}  // namespace
}  // namespace skyquilt::buildings
