#include "prepare/georeference/checks/result_checks.h"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/base/random.h"
#include "tests/prepare/georeference/lawnmower_photos.h"

namespace skyquilt::test {
namespace {

using namespace prepare::georeference;
using Urgency = Contradiction::Urgency;

constexpr double kTrueFocal_px = 800.0;
constexpr double kTrueHeight_m = 60.0;

// Photos that look straight down over level ground, with right tags. `factor`: of focal length and height, which look alike in such photos.
CheckedResult Nadir(double factor = 1.0, int n = 20) {
  CheckedResult result;
  for (int i = 0; i < n; ++i) {
    const double yaw_deg = i % 2 == 0 ? 20.0 : 200.0;
    CheckedPhoto photo{.cam_from_enu = CamFromEnu({yaw_deg, -90.0, 0.0}),
                       .focal_px = factor * kTrueFocal_px,
                       .longer_side_px = 1000.0,
                       .agl_m = factor * kTrueHeight_m,
                       .tagged_focal_px = kTrueFocal_px,
                       .relative_altitude_m = kTrueHeight_m,
                       .gimbal_yaw_deg = yaw_deg,
                       .gimbal_pitch_deg = -90.0,
                       .gimbal_roll_deg = 0.0};
    result.photos.push_back(photo);
  }
  return result;
}

CheckedResult With(CheckedResult result, const std::function<void(CheckedPhoto&)>& change) {
  for (CheckedPhoto& photo : result.photos) change(photo);
  return result;
}

const Contradiction* Named(const ResultChecks& checks, const std::string& code) {
  const auto found = std::find_if(checks.contradictions.begin(), checks.contradictions.end(), [&](const Contradiction& c) { return c.code == code; });
  return found == checks.contradictions.end() ? nullptr : &*found;
}

// In a warning: a note is only a line of the log.
bool Mentions(const ResultChecks& checks, const std::string& text) {
  return std::any_of(checks.contradictions.begin(), checks.contradictions.end(), [&](const Contradiction& c) {
    const survey::Problem problem = c.ToProblem();
    if (c.urgency == Urgency::kNote) return false;
    return problem.finding.find(text) != std::string::npos || problem.advice.find(text) != std::string::npos;
  });
}

TEST(ResultChecks, GoodTagsSayNothing) {
  for (const double factor : {0.92, 1.0, 1.08}) {
    const ResultChecks checks = CheckResult(Nadir(factor));
    EXPECT_TRUE(checks.contradictions.empty()) << factor;
    EXPECT_EQ(checks.scale_doubt, 0.0);
    EXPECT_EQ(checks.height_doubt_m, 0.0);
  }
  EXPECT_TRUE(CheckResult({}).contradictions.empty());
}

// The case of a focal length tag of 0: nothing but RelativeAltitude knows the height.
TEST(ResultChecks, WithoutFocalTagTheHeightAboveTakeOffIsTheWitness) {
  const ResultChecks checks = CheckResult(With(Nadir(5.0), [](CheckedPhoto& photo) { photo.tagged_focal_px.reset(); }));
  const Contradiction* found = Named(checks, "height_contradicts");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->urgency, Urgency::kPlace);
  EXPECT_EQ(found->n_photos, 20);
  EXPECT_NE(found->cause.find("no focal length tag"), std::string::npos);
  EXPECT_NE(found->remedy.find("28.8 mm"), std::string::npos) << found->remedy;  // 36 mm * 800 / 1000
  EXPECT_GE(checks.scale_doubt, 4.0 - 1e-9);
  EXPECT_GE(checks.height_doubt_m, 240.0 - 1e-9);
}

TEST(ResultChecks, AFarFocalLengthIsNamedWithTheWitnessThatDecides) {
  const auto wrong_tag = [](double times) { return [times](CheckedPhoto& photo) { photo.tagged_focal_px = times * kTrueFocal_px; }; };
  // RelativeAltitude agrees with the result: the tag is wrong.
  const ResultChecks tag = CheckResult(With(Nadir(), wrong_tag(2.0)));
  ASSERT_NE(Named(tag, "focal_far"), nullptr);
  EXPECT_NE(Named(tag, "focal_far")->cause.find("tagged focal length is probably wrong"), std::string::npos);
  EXPECT_EQ(Named(tag, "focal_far")->urgency, Urgency::kWarning);
  EXPECT_EQ(Named(tag, "height_contradicts"), nullptr);
  EXPECT_EQ(tag.scale_doubt, 0.0);
  // Both contradict the result.
  const ResultChecks poses = CheckResult(Nadir(1.8));
  ASSERT_NE(Named(poses, "focal_far"), nullptr);
  EXPECT_NE(Named(poses, "focal_far")->cause.find("The one found is probably wrong"), std::string::npos);
  EXPECT_NE(Named(poses, "height_contradicts"), nullptr);
  EXPECT_NEAR(poses.scale_doubt, 0.8, 1e-9);
  // The result follows a wrong tag.
  const ResultChecks follows = CheckResult(With(Nadir(0.5), wrong_tag(0.5)));
  EXPECT_EQ(Named(follows, "focal_far"), nullptr);
  ASSERT_NE(Named(follows, "height_contradicts"), nullptr);
  EXPECT_NE(Named(follows, "height_contradicts")->cause.find("tagged focal length is wrong"), std::string::npos);
  EXPECT_GE(follows.scale_doubt, 1.0 - 1e-9);
  // Nothing decides.
  const ResultChecks open = CheckResult(With(Nadir(1.5), [](CheckedPhoto& photo) { photo.relative_altitude_m.reset(); }));
  ASSERT_NE(Named(open, "focal_far"), nullptr);
  EXPECT_NEAR(open.scale_doubt, 0.5, 1e-9);
  EXPECT_NEAR(open.height_doubt_m, kTrueHeight_m * 0.5, 1e-9);
}

TEST(ResultChecks, SmallDifferencesOfHeightAreNotesOrWarnings) {
  // Take-off from a hill.
  const ResultChecks hill = CheckResult(With(Nadir(), [](CheckedPhoto& photo) { photo.relative_altitude_m = kTrueHeight_m - 10.0; }));
  ASSERT_NE(Named(hill, "height_differs"), nullptr);
  EXPECT_EQ(Named(hill, "height_differs")->urgency, Urgency::kNote);
  EXPECT_EQ(hill.scale_doubt, 0.0);
  EXPECT_NE(Named(hill, "height_differs")->cause.find("10 m above"), std::string::npos);
  const ResultChecks untagged = CheckResult(With(Nadir(1.2), [](CheckedPhoto& photo) { photo.tagged_focal_px.reset(); }));
  ASSERT_NE(Named(untagged, "height_differs"), nullptr);
  EXPECT_EQ(Named(untagged, "height_differs")->urgency, Urgency::kWarning);
  EXPECT_NEAR(untagged.scale_doubt, 0.2, 1e-9);
  // Focal length and height differ from their tags by the same factor: the tags agree with each other.
  const ResultChecks both = CheckResult(Nadir(1.2));
  ASSERT_NE(Named(both, "height_differs"), nullptr);
  EXPECT_EQ(Named(both, "height_differs")->urgency, Urgency::kWarning);
  EXPECT_NEAR(both.scale_doubt, 0.2, 1e-9);
  // Low flights: few metres are no contradiction.
  const ResultChecks low = CheckResult(With(Nadir(), [](CheckedPhoto& photo) {
    photo.agl_m = 9.0;
    photo.relative_altitude_m = 7.0;
  }));
  EXPECT_TRUE(low.contradictions.empty());
}

TEST(ResultChecks, ZerosAndFewTagsOfHeightAreNone) {
  const auto all = [](std::optional<double> height_m) { return [height_m](CheckedPhoto& photo) { photo.relative_altitude_m = height_m; }; };
  EXPECT_FALSE(CheckResult(With(Nadir(), all(0.0))).height.Known());
  EXPECT_FALSE(CheckResult(With(Nadir(), all(std::nullopt))).height.Known());
  CheckedResult some = With(Nadir(), all(0.0));
  for (size_t i = 0; i < 9; ++i) some.photos[i].relative_altitude_m = kTrueHeight_m;
  EXPECT_EQ(CheckResult(some).height.n, 9);
  EXPECT_TRUE(CheckResult(some).contradictions.empty());
  for (size_t i = 2; i < 9; ++i) some.photos[i].relative_altitude_m.reset();
  EXPECT_FALSE(CheckResult(some).height.Known());
}

TEST(ResultChecks, WithoutAnyWitnessTheCauseIsSaid) {
  const auto no_height = [](CheckedPhoto& photo) { photo.relative_altitude_m.reset(); };
  const ResultChecks tagged = CheckResult(With(Nadir(), no_height));
  ASSERT_EQ(tagged.contradictions.size(), 1U);
  EXPECT_EQ(tagged.contradictions[0].code, "height_unchecked");
  EXPECT_EQ(tagged.contradictions[0].urgency, Urgency::kNote);
  const ResultChecks differs = CheckResult(With(Nadir(1.2), no_height));
  ASSERT_NE(Named(differs, "focal_differs"), nullptr);
  EXPECT_EQ(Named(differs, "focal_differs")->urgency, Urgency::kWarning);
  EXPECT_NEAR(differs.scale_doubt, 0.2, 1e-9);
  CheckedResult nothing = With(With(Nadir(), no_height), [](CheckedPhoto& photo) { photo.tagged_focal_px.reset(); });
  EXPECT_NE(Named(CheckResult(nothing), "focal_unknown"), nullptr);
  EXPECT_GT(CheckResult(nothing).height_doubt_m, 0.0);
  // A given model's lens may have been calibrated, control points decide, and photos at an angle tell the focal length.
  CheckedResult given = nothing;
  given.own_poses = false;
  EXPECT_TRUE(CheckResult(given).contradictions.empty());
  CheckedResult control = nothing;
  control.by_control = true;
  EXPECT_TRUE(CheckResult(control).contradictions.empty());
  const CheckedResult oblique = With(nothing, [](CheckedPhoto& photo) {
    photo.cam_from_enu = CamFromEnu({*photo.gimbal_yaw_deg, -50.0, 0.0});
    photo.gimbal_pitch_deg = -50.0;
  });
  EXPECT_TRUE(CheckResult(oblique).contradictions.empty());
}

// Five cases of scripts/tag_faults.py, photos of 200 pixels and 45 m above ground, without RelativeAltitude: the result follows a wrong tag, and what
// the photos themselves know of the focal length is too little to contradict it.
TEST(ResultChecks, AHeightThatFollowsTheTaggedFocalLengthAloneIsAWarning) {
  struct Case {
    double film_mm, focal_px, agl_m, focal_sigma, scale_percent;
    const char* reason;
  };
  const Case cases[] = {{31.0, 177.1, 54.3, 0.059, 0.25, "to 6 % only"},
                        {16.0, 92.3, 28.8, 0.142, 0.27, "to 14 % only"},
                        {9.0, 51.7, 16.2, 0.442, 0.28, "to 44 % only"},
                        {13.0, 74.7, 23.3, 0.213, 0.29, "to 21 % only"},
                        {74.0, 422.9, 215.8, 0.028, 3.37, "uncertain by 3.4 %"}};
  for (const Case& wrong : cases) {
    CheckedResult result = With(Nadir(1.0, 28), [&](CheckedPhoto& photo) {
      photo.focal_px = wrong.focal_px;
      photo.longer_side_px = 200.0;
      photo.agl_m = wrong.agl_m;
      photo.tagged_focal_px = wrong.film_mm / 36.0 * 200.0;
      photo.relative_altitude_m.reset();
    });
    result.focal_sigma = [&] { return wrong.focal_sigma; };
    result.scale_percent = wrong.scale_percent;
    const ResultChecks checks = CheckResult(result);
    ASSERT_EQ(checks.contradictions.size(), 1U) << wrong.film_mm;
    const Contradiction& found = checks.contradictions[0];
    EXPECT_EQ(found.code, "height_unchecked");
    EXPECT_EQ(found.urgency, Urgency::kWarning);
    const std::string finding = found.ToProblem().finding;
    EXPECT_NE(finding.find("focal length"), std::string::npos) << finding;
    EXPECT_NE(finding.find(wrong.reason), std::string::npos) << finding;
    EXPECT_NE(finding.find(fmt::format("{:.0f} mm", wrong.film_mm)), std::string::npos) << finding;
    EXPECT_NEAR(checks.height_doubt_m, 0.1 * wrong.agl_m, 1e-9);
    EXPECT_EQ(checks.scale_doubt, 0.0);
  }
}

TEST(ResultChecks, PhotosThatTellTheFocalLengthCheckItsTag) {
  const auto no_height = [](CheckedPhoto& photo) { photo.relative_altitude_m.reset(); };
  const auto urgency = [](const CheckedResult& result, const char* code) {
    const ResultChecks checks = CheckResult(result);
    EXPECT_EQ(checks.height_doubt_m, 0.0);
    const Contradiction* found = Named(checks, code);
    EXPECT_NE(found, nullptr);
    return found == nullptr ? Urgency::kPlace : found->urgency;
  };
  // Brighton Beach and Seneca, without their heights above take-off; and a model whose observations cannot be read.
  for (const double sigma : {0.0059, 0.0002, std::numeric_limits<double>::quiet_NaN()}) {
    CheckedResult good = With(Nadir(), no_height);
    good.focal_sigma = [sigma] { return sigma; };
    good.scale_percent = 0.45;
    EXPECT_EQ(urgency(good, "height_unchecked"), Urgency::kNote) << sigma;
  }
  // Likewise they tell a hill from a wrong tag.
  CheckedResult hill = With(Nadir(), [](CheckedPhoto& photo) { photo.relative_altitude_m = kTrueHeight_m - 10.0; });
  hill.focal_sigma = [] { return 0.0059; };
  EXPECT_EQ(urgency(hill, "height_differs"), Urgency::kNote);
  hill.focal_sigma = [] { return 0.06; };
  EXPECT_EQ(urgency(hill, "height_differs"), Urgency::kWarning);
  // Control points and a given model do not follow the tags.
  hill.own_poses = false;
  EXPECT_EQ(urgency(hill, "height_differs"), Urgency::kNote);
  hill.own_poses = true;
  hill.by_control = true;
  EXPECT_EQ(urgency(hill, "height_differs"), Urgency::kNote);
  // Where tags confirm the height, nobody asks.
  bool asked = false;
  CheckedResult confirmed = Nadir();
  confirmed.focal_sigma = [&] {
    asked = true;
    return 0.06;
  };
  EXPECT_TRUE(CheckResult(confirmed).contradictions.empty());
  EXPECT_FALSE(asked);
}

TEST(ResultChecks, ControlPointsAreNotOverruled) {
  CheckedResult result = Nadir(1.8);
  result.by_control = true;
  const ResultChecks checks = CheckResult(result);
  EXPECT_FALSE(checks.contradictions.empty());
  for (const Contradiction& c : checks.contradictions) EXPECT_EQ(c.urgency, Urgency::kWarning) << c.code;
  EXPECT_EQ(checks.scale_doubt, 0.0);
}

TEST(ResultChecks, WrongGimbalAnglesAreNamed) {
  struct Case {
    const char* text;
    std::function<void(CheckedPhoto&)> change;
  };
  const Case cases[] = {{"opposite sign", [](CheckedPhoto& photo) { photo.gimbal_pitch_deg = 90.0; }},
                        {"measured from straight down",
                         [](CheckedPhoto& photo) {
                           photo.gimbal_pitch_deg = 2.0;
                           photo.gimbal_roll_deg = 1.0;
                         }},
                        {"angles are 0",
                         [](CheckedPhoto& photo) {
                           photo.gimbal_yaw_deg = 0.0;
                           photo.gimbal_pitch_deg = 0.0;
                         }},
                        {"of the aircraft", [](CheckedPhoto& photo) {
                           photo.gimbal_pitch_deg = -20.0;
                           photo.gimbal_roll_deg = 50.0;
                         }}};
  for (const Case& wrong : cases) {
    CheckedResult result = With(Nadir(), wrong.change);
    result.gimbal = {GimbalUse::kDropped, 90.0};
    const ResultChecks checks = CheckResult(result);
    const Contradiction* found = Named(checks, "gimbal_contradicts");
    ASSERT_NE(found, nullptr) << wrong.text;
    EXPECT_NE(found->cause.find(wrong.text), std::string::npos) << found->cause;
    EXPECT_EQ(found->n_photos, 20);
    EXPECT_EQ(found->urgency, Urgency::kPlace);
  }
  // A few bad ones among good ones do no harm.
  CheckedResult few = Nadir();
  for (size_t i = 0; i < 2; ++i) few.photos[i].gimbal_pitch_deg = 90.0;
  EXPECT_TRUE(CheckResult(few).contradictions.empty());
  few.photos[2].gimbal_pitch_deg = few.photos[3].gimbal_pitch_deg = 90.0;
  ASSERT_NE(Named(CheckResult(few), "gimbal_contradicts"), nullptr);
  EXPECT_EQ(Named(CheckResult(few), "gimbal_contradicts")->urgency, Urgency::kWarning);
  CheckedResult doubted = Nadir();
  doubted.gimbal = {GimbalUse::kDoubted, 60.0};
  ASSERT_NE(Named(CheckResult(doubted), "gimbal_doubted"), nullptr);
  EXPECT_EQ(CheckResult(doubted).tilt_doubt_deg, 60.0);
}

TEST(ResultChecks, ATurnOfTheYawIsAWarning) {
  for (const double turn_deg : {90.0, -90.0, 180.0}) {
    const ResultChecks checks = CheckResult(With(Nadir(), [&](CheckedPhoto& photo) { *photo.gimbal_yaw_deg += turn_deg; }));
    const Contradiction* found = Named(checks, "gimbal_turned");
    ASSERT_NE(found, nullptr) << turn_deg;
    EXPECT_EQ(found->urgency, Urgency::kWarning);
    const std::string side = turn_deg == 90.0 ? "90\xC2\xB0 to the left" : turn_deg == -90.0 ? "90\xC2\xB0 to the right" : "180\xC2\xB0";
    EXPECT_NE(found->found.find(side), std::string::npos) << found->found;
  }
  // Magnetic declination, and yaws that have nothing to do with the cameras.
  EXPECT_TRUE(CheckResult(With(Nadir(), [](CheckedPhoto& photo) { *photo.gimbal_yaw_deg += 20.0; })).contradictions.empty());
  double any_deg = 0.0;
  EXPECT_TRUE(CheckResult(With(Nadir(), [&](CheckedPhoto& photo) { *photo.gimbal_yaw_deg = any_deg += 77.0; })).contradictions.empty());
}

TEST(ApplyChecks, WidensTheAccuracyAndPutsTheWorstFirst) {
  survey::Survey survey;
  survey.georeferenced = true;
  survey.fit.accuracy = {.scale_percent = 4.8, .tilt_deg = 0.3, .yaw_deg = 0.2, .horizontal_m = 1.5, .vertical_m = 3.0};
  survey.problems = {{"scale_uncertain", "by 4.8 %", "", true}, {"tags_disagree", "", "", false}};
  const ResultChecks checks = CheckResult(With(Nadir(5.0), [](CheckedPhoto& photo) { photo.tagged_focal_px.reset(); }));
  ApplyChecks(checks, survey);
  EXPECT_NEAR(survey.fit.accuracy.scale_percent, 400.0, 1e-6);
  EXPECT_NEAR(survey.fit.accuracy.vertical_m, 240.0, 1e-6);
  ASSERT_EQ(survey.problems.size(), 3U);
  EXPECT_NE(survey.problems[0].finding.find("400.0 %"), std::string::npos);
  EXPECT_EQ(survey.problems[1].code, "height_contradicts");
  EXPECT_EQ(survey.problems[2].code, "tags_disagree");
}

TEST(ApplyChecks, LeavesAGoodSurveyAsItIs) {
  survey::Survey survey;
  survey.fit.accuracy.scale_percent = 0.4;
  survey.problems = {{"tags_disagree", "", "", false}, {"one_line", "", "", true}};
  const std::vector<survey::Problem> before = survey.problems;
  ApplyChecks(CheckResult(Nadir()), survey);
  EXPECT_EQ(survey.problems, before);
  EXPECT_EQ(survey.fit.accuracy.scale_percent, 0.4);
  EXPECT_TRUE(std::isnan(survey.fit.accuracy.vertical_m));
}

// Whatever is wrong with the tags, and whatever the search for poses has made of it.
RC_GTEST_PROP(ResultChecks, NoHeightIsSilentlyWrong, ()) {
  const auto seed = *rc::gen::arbitrary<uint32_t>();
  base::Random random(seed);
  const double tag_error = std::exp(random.Uniform(std::log(0.3), std::log(3.0)));
  const bool has_focal = random.Uniform(0.0, 1.0) < 0.7, right_tag = random.Uniform(0.0, 1.0) < 0.3, follows_tag = random.Uniform(0.0, 1.0) < 0.6;
  const bool has_height = random.Uniform(0.0, 1.0) < 0.6, zeros = random.Uniform(0.0, 1.0) < 0.3, wrong_sign = random.Uniform(0.0, 1.0) < 0.3;
  const double tagged = right_tag ? 1.0 : tag_error;
  const double drift = std::exp(random.Uniform(std::log(0.2), std::log(6.0)));
  const double factor = has_focal && follows_tag ? tagged : drift;
  CheckedResult result = Nadir(factor);
  result.focal_sigma = [] { return 0.06; };
  for (CheckedPhoto& photo : result.photos) {
    photo.tagged_focal_px = has_focal ? std::optional(tagged * kTrueFocal_px) : std::nullopt;
    const bool zero = zeros && random.Uniform(0.0, 1.0) < 0.4;
    if (zero) photo.relative_altitude_m = 0.0;
    if (!has_height) photo.relative_altitude_m.reset();
    if (wrong_sign) photo.gimbal_pitch_deg = 90.0;
  }
  const ResultChecks checks = CheckResult(result);
  const bool right = factor > 0.9 && factor < 1.1;
  const bool named = Mentions(checks, "focal length") && Mentions(checks, "height");
  RC_ASSERT(right || named);
  // What the survey states covers it where tags contradict it by more than hills do.
  const bool contradicts = checks.height.Contradicts();
  const bool covered = (1.0 + checks.scale_doubt) * 1.001 >= std::max(factor, 1.0 / factor);
  RC_ASSERT(!contradicts || covered);
  const bool sign_named = Mentions(checks, "opposite sign");
  RC_ASSERT(sign_named == wrong_sign);
  for (const Contradiction& c : checks.contradictions) {
    RC_ASSERT(!c.found.empty());
    RC_ASSERT(!c.tags.empty());
    RC_ASSERT(!c.cause.empty());
    RC_ASSERT(!c.remedy.empty());
    RC_ASSERT(c.n_photos > 0);
  }
}

}  // namespace
}  // namespace skyquilt::test
