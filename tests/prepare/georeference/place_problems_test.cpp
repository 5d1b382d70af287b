#include "prepare/georeference/place_problems.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "prepare/georeference/georeference.h"

namespace skyquilt::prepare::georeference {
namespace {

// A fit without anything to complain about.
survey::GeoFit GoodFit() {
  survey::GeoFit fit;
  fit.n_matches = fit.n_inliers = 40;
  fit.accuracy = {.scale_percent = 0.2, .tilt_deg = 0.3, .yaw_deg = 0.2, .horizontal_m = 1.5, .vertical_m = 3.0};
  fit.tags_alone_tilt_deg = 0.5;
  return fit;
}

std::vector<std::string> Codes(const std::vector<survey::Problem>& problems) {
  std::vector<std::string> codes;
  codes.reserve(problems.size());
  for (const survey::Problem& problem : problems) codes.push_back(problem.code);
  return codes;
}

using List = std::vector<std::string>;

TEST(PlaceProblems, AGoodFitHasNone) {
  const survey::GeoFit fit = GoodFit();
  EXPECT_TRUE(PlaceProblems({.fit = fit, .gimbal_used = true}).empty());
  EXPECT_TRUE(TooUncertain(fit, false).empty());
}

TEST(PlaceProblems, EachIsASentenceWithoutItsFullStop) {
  survey::GeoFit fit = GoodFit();
  fit.tags_alone_tilt_deg = 4.0;
  fit.accuracy.scale_percent = 2.5;
  fit.accuracy.tilt_deg = 2.0;
  fit.gravity = {{.kind = "ground", .lean_east_deg = 6.0, .lean_north_deg = 3.0}};
  fit.n_inliers = 38;
  const std::vector<survey::Problem> most = PlaceProblems({.fit = fit, .disagreeing = {"a.jpg", "b.jpg"}, .one_line = true, .vertical_span_m = 20.0});
  fit.n_inliers = 12;
  const std::vector<survey::Problem> rest = PlaceProblems({.fit = fit, .disagreeing = {"a.jpg"}, .heights = HeightTags::kRelative});
  std::map<std::string, survey::Problem> all;
  for (const auto& problems : {most, rest}) {
    for (const survey::Problem& problem : problems) all[problem.code] = problem;
  }
  EXPECT_EQ(all.size(), 8U);
  for (const char* code :
       {"few_tags_agree", "tags_disagree", "gravity_conflict", "ground_leans", "one_line", "no_heights", "height_drift", "scale_uncertain"})
    EXPECT_TRUE(all.contains(code)) << code;
  for (const auto& [code, problem] : all) {
    EXPECT_GT(problem.finding.size(), 20U) << code;
    EXPECT_GT(problem.advice.size(), 20U) << code;
    EXPECT_FALSE(problem.finding.ends_with(".")) << code;
    EXPECT_FALSE(problem.advice.ends_with(".")) << code;
    EXPECT_EQ(problem.about_place, code != "tags_disagree") << code;
  }
  // The worst first: what concerns the place.
  EXPECT_EQ(most.back().code, "tags_disagree");
  EXPECT_NE(most.back().finding.find("a.jpg, b.jpg"), std::string::npos);
}

TEST(PlaceProblems, FewTagsAgreeBelowHalf) {
  survey::GeoFit fit = GoodFit();
  fit.n_inliers = 20;
  const std::vector<std::string> names(20, "p.jpg");
  EXPECT_EQ(Codes(PlaceProblems({.fit = fit, .disagreeing = names})), (List{"tags_disagree"}));
  EXPECT_NE(PlaceProblems({.fit = fit, .disagreeing = names})[0].finding.find("and 12 more"), std::string::npos);
  fit.n_inliers = 19;
  EXPECT_EQ(Codes(PlaceProblems({.fit = fit, .disagreeing = names})), (List{"few_tags_agree"}));
}

TEST(PlaceProblems, AConflictMustExceedTheUncertainty) {
  survey::GeoFit fit = GoodFit();
  fit.tags_alone_tilt_deg = kWarnConflict_deg + 0.5;
  EXPECT_EQ(Codes(PlaceProblems({.fit = fit})), (List{"gravity_conflict"}));
  EXPECT_TRUE(PlaceProblems({.fit = fit, .tags_alone_sigma_deg = 1.2, .gravity_sigma_deg = 0.5}).empty());
  fit.tags_alone_tilt_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(PlaceProblems({.fit = fit}).empty());
}

TEST(PlaceProblems, ALeaningGroundMattersWithoutGimbalAngles) {
  survey::GeoFit fit = GoodFit();
  fit.gravity = {{.kind = "cameras"}, {.kind = "ground", .lean_east_deg = 4.0, .lean_north_deg = -4.0}};
  EXPECT_TRUE(PlaceProblems({.fit = fit, .gimbal_used = true}).empty());
  ASSERT_EQ(Codes(PlaceProblems({.fit = fit})), (List{"ground_leans"}));
  EXPECT_FALSE(PlaceProblems({.fit = fit})[0].about_place);  // other evidence makes the tilt certain
  fit.accuracy.tilt_deg = 1.5;
  EXPECT_TRUE(PlaceProblems({.fit = fit})[0].about_place);
  fit.gravity[1].lean_east_deg = fit.gravity[1].lean_north_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(PlaceProblems({.fit = fit}).empty());
}

TEST(PlaceProblems, HeightsAreMissingOrDriftButNotBoth) {
  const survey::GeoFit fit = GoodFit();
  EXPECT_EQ(Codes(PlaceProblems({.fit = fit, .vertical_span_m = 5.5})), (List{"height_drift"}));
  EXPECT_TRUE(PlaceProblems({.fit = fit, .vertical_span_m = 4.5}).empty());
  EXPECT_EQ(Codes(PlaceProblems({.fit = fit, .heights = HeightTags::kUnknown, .vertical_span_m = 5.5})), (List{"no_heights"}));
}

TEST(PlaceProblems, TwoGroupsOfTagsAreNamed) {
  const survey::GeoFit fit = GoodFit();
  const std::vector<survey::Problem> problems =
      PlaceProblems({.fit = fit, .disagreeing = {"a.jpg", "b.jpg", "c.jpg", "d.jpg"}, .second_group = 4, .second_group_m = 31.4});
  EXPECT_EQ(Codes(problems), (List{"two_groups", "tags_disagree"}));
  EXPECT_NE(problems.front().finding.find("two groups 31 m apart"), std::string::npos);
  EXPECT_TRUE(problems.front().about_place);
}

TEST(TooUncertain, OnOneLineHalfOfTheTagsMustAgree) {
  survey::GeoFit fit = GoodFit();
  fit.n_matches = 20;
  fit.n_inliers = 9;
  EXPECT_TRUE(TooUncertain(fit, false).empty());
  EXPECT_EQ(Codes(TooUncertain(fit, true)), (List{"too_few_agree"}));
  fit.n_inliers = 10;
  EXPECT_TRUE(TooUncertain(fit, true).empty());
}

TEST(TooUncertain, HasAThresholdForEachNumber) {
  survey::GeoFit fit = GoodFit();
  fit.n_inliers = kMinAgreeing;
  fit.accuracy.scale_percent = kMaxScaleSigma_percent;
  fit.accuracy.tilt_deg = kMaxTiltSigma_deg;
  EXPECT_TRUE(TooUncertain(fit, false).empty());
  fit.accuracy.tilt_deg = 1.01 * kMaxTiltSigma_deg;
  EXPECT_EQ(Codes(TooUncertain(fit, false)), (List{"tilt_unknown"}));
  fit.accuracy.tilt_deg = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Codes(TooUncertain(fit, false)), (List{"tilt_unknown"}));
  fit.accuracy.scale_percent = 1.01 * kMaxScaleSigma_percent;
  EXPECT_EQ(Codes(TooUncertain(fit, false)), (List{"scale_unknown"}));
  fit.n_inliers = kMinAgreeing - 1;
  ASSERT_EQ(Codes(TooUncertain(fit, false)), (List{"too_few_agree"}));
  const survey::Problem problem = TooUncertain(fit, false)[0];
  EXPECT_TRUE(problem.about_place);
  EXPECT_TRUE(problem.finding.starts_with("No place on Earth: "));
  EXPECT_FALSE(problem.finding.ends_with("."));
  EXPECT_FALSE(problem.advice.ends_with("."));
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
