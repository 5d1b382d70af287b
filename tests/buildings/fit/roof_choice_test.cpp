#include "buildings/fit/roof_choice.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/random.h"

namespace skyquilt::buildings {
namespace {

constexpr double kTolerance_m = 0.4;

struct RoofPlan {
  RoofKind roof = RoofKind::kGable;
  bool along_u = true;
  double length = 12.0, width = 8.0;
  double eave = 5.0, rise = 0.7;  // of pitched roofs; a flat one's slope along v
  double noise = 0.1;
  double parapet = 0.0;
  bool boxes = false;  // and chimneys
};

double HeightOf(const RoofPlan& plan, double u, double v) {
  const double du = std::min(u, plan.length - u), dv = std::min(v, plan.width - v);
  if (plan.roof == RoofKind::kFlat) return plan.eave + plan.rise * v;
  return plan.eave + plan.rise * (plan.roof == RoofKind::kHip ? std::min(du, dv) : plan.along_u ? dv : du);
}

std::vector<Eigen::Vector3d> PointsOn(const RoofPlan& plan, uint64_t seed) {
  base::Random random(seed);
  std::vector<Eigen::Vector3d> points;
  const double out = plan.roof == RoofKind::kFlat ? 0.0 : 0.4;
  for (double u = -out; u < plan.length + out; u += 0.28) {
    for (double v = -out; v < plan.width + out; v += 0.28) {
      double z = HeightOf(plan, u, v) + plan.noise * random.Normal();
      const double inside = std::min({u, v, plan.length - u, plan.width - v});
      if (plan.parapet > 0.0 && inside < 0.35) z += plan.parapet;
      if (plan.boxes && std::abs(u - 0.7 * plan.length) < 1.3 && std::abs(v - 0.6 * plan.width) < 1.0) z = HeightOf(plan, u, v) + 1.8;
      if (plan.boxes && std::abs(u - 0.2 * plan.length) < 0.5 && std::abs(v - 0.3 * plan.width) < 0.5) z = HeightOf(plan, u, v) + 0.9;
      points.emplace_back(u, v, z);
    }
  }
  return points;
}

// Share of the points that lie on the true roof: not those of parapets, boxes and chimneys.
double ShareOnRoof(const RoofPlan& plan, uint64_t seed) {
  const std::vector<Eigen::Vector3d> points = PointsOn(plan, seed);
  const auto on_roof = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    return std::abs(point.z() - HeightOf(plan, point.x(), point.y())) <= kTolerance_m;
  });
  return static_cast<double>(on_roof) / static_cast<double>(points.size());
}

RoofFit Choose(const RoofPlan& plan, uint64_t seed = 1) {
  const std::vector<Eigen::Vector3d> points = PointsOn(plan, seed);
  return ChooseRoof(points, {0, 0}, {plan.length, plan.width}, kTolerance_m, static_cast<double>(points.size()) / 10.0);
}

RC_GTEST_PROP(RoofChoice, FindsTheRoofOfAnySize, ()) {
  RoofPlan plan;
  plan.roof = *rc::gen::element(RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip);
  plan.length = *rc::gen::inRange(80, 250) / 10.0;
  plan.width = *rc::gen::inRange(60, 150) / 10.0;
  plan.rise = plan.roof == RoofKind::kFlat ? 0.0 : *rc::gen::inRange(30, 100) / 100.0;
  plan.along_u = *rc::gen::arbitrary<bool>();
  plan.boxes = *rc::gen::arbitrary<bool>();
  plan.parapet = plan.roof == RoofKind::kFlat ? *rc::gen::inRange(0, 10) / 10.0 : 0.0;
  const auto seed = *rc::gen::inRange<uint64_t>(1, 1000);
  const RoofFit fit = Choose(plan, seed);
  RC_ASSERT(fit.roof == plan.roof);
  RC_ASSERT(std::abs(fit.eave_z - plan.eave) < 0.1);
  if (plan.roof == RoofKind::kFlat) {
    RC_ASSERT(fit.eave_z == fit.ridge_z);
  } else {
    const double reach = 0.5 * (plan.roof == RoofKind::kHip ? std::min(plan.length, plan.width) : plan.along_u ? plan.width : plan.length);
    RC_ASSERT(std::abs(fit.ridge_z - plan.eave - plan.rise * reach) < 0.12);
    if (plan.roof == RoofKind::kGable) RC_ASSERT(fit.along_u == plan.along_u);
    if (plan.roof == RoofKind::kHip) RC_ASSERT(fit.along_u == (plan.length >= plan.width));
  }
  RC_ASSERT(std::abs(fit.share_within - ShareOnRoof(plan, seed)) < 0.05);
}

TEST(RoofChoice, SlightlySlopedRoofsStayFlat) {
  RoofPlan plan;
  plan.roof = RoofKind::kFlat;
  plan.length = 14.0;
  plan.width = 10.0;
  plan.rise = std::tan(3.0 * std::numbers::pi / 180.0);
  EXPECT_EQ(Choose(plan).roof, RoofKind::kFlat);
  RoofPlan low;  // a gable of 3 degrees is none
  low.rise = plan.rise;
  EXPECT_EQ(Choose(low).roof, RoofKind::kFlat);
}

TEST(RoofChoice, DeckIsBelowWhatStandsOnIt) {
  RoofPlan plan;
  plan.roof = RoofKind::kFlat;
  plan.rise = 0.0;
  plan.length = 9.0;
  plan.width = 7.0;
  std::vector<Eigen::Vector3d> points = PointsOn(plan, 4);
  for (Eigen::Vector3d& point : points) {
    if (point.x() > 4.0 && point.y() > 1.5) point.z() += 2.5;  // 45 % of the roof
  }
  const RoofFit fit = ChooseRoof(points, {0, 0}, {9, 7}, kTolerance_m, 60.0);
  EXPECT_EQ(fit.roof, RoofKind::kFlat);
  EXPECT_NEAR(fit.eave_z, 5.0, 0.05);
  EXPECT_LT(fit.share_within, 0.7);
}

TEST(RoofChoice, WallsMayBeAtTheRoofsEdge) {
  RoofPlan plan;
  const std::vector<Eigen::Vector3d> points = PointsOn(plan, 2);
  const RoofFit fit = ChooseRoof(points, {-0.4, -0.4}, {12.4, 8.4}, kTolerance_m, 100.0);
  EXPECT_EQ(fit.roof, RoofKind::kGable);
  EXPECT_NEAR(fit.eave_z, 5.0 - 0.4 * 0.7, 0.05);
  EXPECT_NEAR(fit.ridge_z, 7.8, 0.05);
}

TEST(RoofChoice, BetterFitsHaveLowerBic) {
  RoofPlan gable;
  const std::vector<Eigen::Vector3d> points = PointsOn(gable, 3);
  const RoofFit right = ChooseRoof(points, {0, 0}, {12, 8}, kTolerance_m, 100.0);
  const RoofFit wrong = ChooseRoof(points, {0, 3}, {12, 11}, kTolerance_m, 100.0);
  EXPECT_LT(right.bic, wrong.bic);
  EXPECT_GT(right.share_within, 0.99);
}

TEST(RoofChoice, FewPointsGiveFiniteFigures) {
  const std::vector<Eigen::Vector3d> one = {{1, 1, 5}};
  for (const std::span<const Eigen::Vector3d>& points : {std::span<const Eigen::Vector3d>(), std::span<const Eigen::Vector3d>(one)}) {
    const RoofFit fit = ChooseRoof(points, {0, 0}, {4, 3}, kTolerance_m, 0.0);
    EXPECT_EQ(fit.roof, RoofKind::kFlat);
    EXPECT_TRUE(std::isfinite(fit.eave_z) && std::isfinite(fit.ridge_z) && std::isfinite(fit.bic));
  }
  EXPECT_NEAR(ChooseRoof(one, {0, 0}, {4, 3}, kTolerance_m, 1.0).eave_z, 5.0, 0.02);
  const std::vector<Eigen::Vector3d> same(50, Eigen::Vector3d(2, 1, 7));
  EXPECT_TRUE(std::isfinite(ChooseRoof(same, {0, 0}, {0, 0}, kTolerance_m, 10.0).eave_z));
}

}  // namespace
}  // namespace skyquilt::buildings
