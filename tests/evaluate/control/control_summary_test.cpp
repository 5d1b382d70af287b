#include "evaluate/control/control_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluate/control/control_json.h"

namespace skyquilt::evaluate::control {
namespace {

using Eigen::Vector3d;
using survey::ControlPointFit;
using survey::ControlUse;

ControlPointFit Point(ControlUse use, const Vector3d& error_m, double gsd_m = 0.02) {
  ControlPointFit point;
  point.label = "p";
  point.use = use;
  point.error_m = error_m;
  point.gsd_m = gsd_m;
  return point;
}

survey::ControlFit FitOf(std::vector<ControlPointFit> points) {
  survey::ControlFit fit;
  fit.points = std::move(points);
  return fit;
}

// Errors 3, 1 east: mean 2, standard deviation sqrt(2), RMSE sqrt(5); 0, 4 north; height known of one point only.
TEST(ControlSummary, FiguresAreThoseWorkedOutByHand) {
  const ControlSummary summary =
      SummariseControl(FitOf({Point(ControlUse::kCheck, {0.03, 0.0, -0.06}), Point(ControlUse::kCheck, {0.01, 0.04, kNotMeasured}),
                              Point(ControlUse::kControl, {0.5, 0.5, 0.5}), Point(ControlUse::kRejected, {5.0, 0.0, 0.0}),
                              Point(ControlUse::kUnseen, Vector3d::Constant(kNotMeasured))}));
  const ControlErrors& check = summary.check;
  EXPECT_EQ(check.n, 2);
  EXPECT_EQ(check.n_heights, 1);
  EXPECT_NEAR(check.mean_m.x(), 0.02, 1e-12);
  EXPECT_NEAR(check.mean_m.y(), 0.02, 1e-12);
  EXPECT_NEAR(check.mean_m.z(), -0.06, 1e-12);
  EXPECT_NEAR(check.sigma_m.x(), 0.01 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(check.sigma_m.y(), 0.02 * std::sqrt(2.0), 1e-12);
  EXPECT_TRUE(std::isnan(check.sigma_m.z()));
  EXPECT_NEAR(check.rmse_m.x(), 0.01 * std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(check.rmse_m.y(), 0.01 * std::sqrt(8.0), 1e-12);
  EXPECT_NEAR(check.rmse_horizontal_m, 0.01 * std::sqrt(13.0), 1e-12);
  EXPECT_NEAR(check.rmse_vertical_m, 0.06, 1e-12);
  EXPECT_NEAR(check.rmse_horizontal_gsd, 0.5 * std::sqrt(13.0), 1e-9);
  EXPECT_NEAR(check.rmse_vertical_gsd, 3.0, 1e-9);
  EXPECT_TRUE(check.WithinRule().value());
  EXPECT_EQ(summary.control.n, 1);
  EXPECT_EQ(summary.n_rejected, 1);
  EXPECT_EQ(summary.n_unseen, 1);
  EXPECT_EQ(summary.Judged(), &summary.check);
}

// A point's error counts in its own GSD.
TEST(ControlSummary, EachErrorIsOverTheGsdOfItsPoint) {
  const ControlSummary summary =
      SummariseControl(FitOf({Point(ControlUse::kCheck, {0.04, 0.0, 0.0}, 0.02), Point(ControlUse::kCheck, {0.4, 0.0, 0.0}, 0.1)}));
  EXPECT_NEAR(summary.check.rmse_horizontal_gsd, std::sqrt((4.0 + 16.0) / 2.0), 1e-9);
  EXPECT_FALSE(summary.check.WithinRule().value());
  const ControlSummary unknown = SummariseControl(FitOf({Point(ControlUse::kCheck, {0.04, 0.0, 0.0}, kNotMeasured)}));
  EXPECT_FALSE(unknown.check.WithinRule().has_value());
}

TEST(ControlSummary, PointsLeftOutAreJudgedWithoutCheckPoints) {
  ControlPointFit point = Point(ControlUse::kControl, {0.001, 0.0, 0.0});
  const ControlSummary without = SummariseControl(FitOf({point}));
  EXPECT_EQ(without.Judged(), nullptr);
  point.left_out_error_m = {0.05, 0.0, 0.07};
  const ControlSummary summary = SummariseControl(FitOf({point}));
  ASSERT_EQ(summary.Judged(), &summary.left_out);
  EXPECT_NEAR(summary.left_out.rmse_horizontal_m, 0.05, 1e-12);
  EXPECT_FALSE(summary.left_out.WithinRule().value());  // 2.5 GSD horizontally
}

TEST(ControlSummary, SystematicErrorsAreToldFromChance) {
  // Mean 0.3 of the RMSE in both, but of four points and of a hundred.
  std::vector<ControlPointFit> few, many;
  for (int i = 0; i < 100; ++i) {
    const double east_m = 0.003 + (i % 2 == 0 ? 0.0095 : -0.0095), north_m = i % 2 == 0 ? 0.01 : -0.01;
    many.push_back(Point(ControlUse::kCheck, {east_m, north_m, north_m}));
    if (i < 4) few.push_back(many.back());
  }
  const ControlErrors of_few = SummariseControl(FitOf(few)).check, of_many = SummariseControl(FitOf(many)).check;
  const std::array<bool, 3> east_only = {true, false, false}, none = {false, false, false};
  EXPECT_EQ(of_few.Systematic(), east_only);
  EXPECT_EQ(of_few.SystematicBeyondChance(), none);
  EXPECT_EQ(of_many.Systematic(), east_only);
  EXPECT_EQ(of_many.SystematicBeyondChance(), east_only);
}

std::vector<ControlPointFit> CheckPoints(int n) {
  std::vector<ControlPointFit> points;
  for (int i = 0; i < n; ++i) {
    points.push_back(Point(ControlUse::kCheck, {i % 2 == 0 ? 0.03 : -0.03, 0.0, 0.04}));
    points.back().given_sigma_m = {0.04 / std::sqrt(2.0), 0.03};
  }
  return points;
}

TEST(AccuracyStatement, NeedsThirtyCheckPoints) {
  EXPECT_TRUE(AccuracyStatement(SummariseControl(FitOf({}))).starts_with("There are no check points."));
  EXPECT_TRUE(AccuracyStatement(SummariseControl(FitOf(CheckPoints(29)))).starts_with("There are fewer than 30 check points (29)."));
  const std::string stated = AccuracyStatement(SummariseControl(FitOf(CheckPoints(30))));
  EXPECT_TRUE(stated.starts_with("Tested with 30 check points")) << stated;
  // 3 and 4 cm horizontally, 4 and 3 cm vertically.
  EXPECT_NE(stated.find("RMSE_H = 5.0 cm, vertical accuracy RMSE_V = 5.0 cm."), std::string::npos) << stated;
  EXPECT_NE(stated.find("is included: 4.0 cm horizontally, 3.0 cm vertically."), std::string::npos) << stated;
}

TEST(AccuracyStatement, SaysWhatIsMissing) {
  std::vector<ControlPointFit> points = CheckPoints(30);
  for (ControlPointFit& point : points) point.given_sigma_m.setConstant(kNotMeasured);
  points[0].error_m.z() = kNotMeasured;
  const std::string stated = AccuracyStatement(SummariseControl(FitOf(points)));
  EXPECT_NE(stated.find("RMSE_H = 3.0 cm."), std::string::npos) << stated;
  EXPECT_EQ(stated.find("RMSE_V"), std::string::npos) << stated;
  EXPECT_NE(stated.find("Fewer than 30 of them (29) have heights"), std::string::npos) << stated;
  EXPECT_NE(stated.find("not known and not included"), std::string::npos) << stated;
}

TEST(ControlJson, HasGroupsAndPoints) {
  survey::ControlFit fit = FitOf({Point(ControlUse::kCheck, {0.03, 0.0, kNotMeasured}), Point(ControlUse::kRejected, {5.0, 0.0, 0.0})});
  fit.file = "gcp_list.txt";
  fit.placed = true;
  fit.points[1].marks = {{.photo = "a.jpg", .error_px = 0.5, .used = true}, {.photo = "b.jpg"}};
  const nlohmann::ordered_json json = ControlJson(fit);
  EXPECT_EQ(json["file"], "gcp_list.txt");
  EXPECT_EQ(json["placed"], true);
  EXPECT_TRUE(json["control"].is_null());
  EXPECT_EQ(json["check"]["points"], 1);
  EXPECT_EQ(json["check"]["rmse_m"][0], 0.03);
  EXPECT_TRUE(json["check"]["rmse_m"][2].is_null());
  EXPECT_EQ(json["rejected"], 1);
  EXPECT_EQ(json["within_rule"], true);
  ASSERT_EQ(json["points"].size(), 2U);
  EXPECT_EQ(json["points"][1]["use"], "rejected");
  EXPECT_EQ(json["points"][1]["marks"], 2);
  EXPECT_EQ(json["points"][1]["marks_used"], 1);
  EXPECT_TRUE(ControlJson(survey::ControlFit{}).is_null());
}

}  // namespace
}  // namespace skyquilt::evaluate::control
