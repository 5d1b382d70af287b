#include "prepare/georeference/gimbal_check.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "core/base/random.h"
#include "prepare/georeference/gravity.h"
#include "tests/prepare/georeference/lawnmower_photos.h"

namespace skyquilt::test {
namespace {

using namespace prepare::georeference;
using Eigen::Vector3d;

// A lawnmower over level ground in a random frame. `tagged`: what the tags make of pitch and roll.
struct TaggedSurvey {
  geo::Similarity3d model_from_enu;
  std::vector<prepare::input::PreparedPhoto> photos = {};
  std::vector<Vector3d> points = {};
};

TaggedSurvey MakeTagged(uint64_t seed, const std::function<Attitude(int)>& attitude, const std::function<Vector3d(const Attitude&)>& tagged) {
  base::Random random(seed);
  TaggedSurvey survey{.model_from_enu = RandomFrame(random)};
  constexpr int kPhotos = 40;
  for (int i = 0; i < kPhotos; ++i) {
    const Attitude a = attitude(i);
    survey.photos.push_back(PreparedAt(OnLawnmower(i, kPhotos), a, survey.model_from_enu));
    survey.photos.back().up_in_cam = tagged(a);
  }
  for (int i = 0; i < 400; ++i) {
    const double east_m = random.Uniform(-100.0, 100.0);
    const double north_m = random.Uniform(-100.0, 100.0);
    survey.points.push_back(survey.model_from_enu * Vector3d(east_m, north_m, 0.3 * random.Normal()));
  }
  return survey;
}

Attitude LinesDown(int i) {
  return {.yaw_deg = (i / kLine) % 2 == 0 ? 20.0 : 200.0};
}

Attitude OneWayOblique(int) {
  return {.yaw_deg = 120.0, .pitch_deg = -55.0};
}

Vector3d Right(const Attitude& a) {
  return prepare::input::UpInCamera(a.pitch_deg, a.roll_deg);
}

Vector3d OppositePitch(const Attitude& a) {
  return prepare::input::UpInCamera(-a.pitch_deg, a.roll_deg);
}

Vector3d FromStraightDown(const Attitude& a) {
  return prepare::input::UpInCamera(a.pitch_deg + 90.0, a.roll_deg);
}

GimbalVerdict VerdictOf(const TaggedSurvey& survey, const std::optional<Vector3d>& tags_up) {
  return JudgeGimbal(survey.photos, survey.points, [&] { return tags_up; });
}

TEST(GimbalCheck, RightAnglesAreUsed) {
  const std::function<Attitude(int)> kinds[] = {LinesDown, OneWayOblique, [](int i) { return Attitude{.yaw_deg = 36.0 * i, .pitch_deg = -45.0}; },
                                                [](int i) { return Attitude{.yaw_deg = 36.0 * i, .pitch_deg = -10.0}; },
                                                [](int) { return Attitude{.yaw_deg = 70.0, .pitch_deg = -75.0}; }};
  uint64_t seed = 1;
  for (const auto& kind : kinds) {
    TaggedSurvey survey = MakeTagged(seed++, kind, Right);
    EXPECT_EQ(VerdictOf(survey, std::nullopt).use, GimbalUse::kUsed) << seed;
    EXPECT_EQ(VerdictOf(survey, survey.model_from_enu.rotation * Vector3d::UnitZ()).use, GimbalUse::kUsed) << seed;
    survey.points.clear();
    EXPECT_EQ(VerdictOf(survey, std::nullopt).use, GimbalUse::kUsed) << seed;
  }
}

// Cameras that all look at a wall: neither their axes nor the plane of the points say where up is.
TEST(GimbalCheck, AWallDoesNotOverruleTheAngles) {
  TaggedSurvey survey = MakeTagged(
      6, [](int) { return Attitude{.yaw_deg = 0.0, .pitch_deg = -5.0}; }, Right);
  base::Random random(12);
  for (Vector3d& point : survey.points) {
    const double east_m = random.Uniform(-60.0, 60.0);
    const double up_m = random.Uniform(30.0, 90.0);
    point = survey.model_from_enu * Vector3d(east_m, 150.0, up_m);
  }
  EXPECT_EQ(VerdictOf(survey, std::nullopt).use, GimbalUse::kUsed);
}

TEST(GimbalCheck, OppositePitchIsDroppedWhenPointsOrTagsContradictIt) {
  TaggedSurvey survey = MakeTagged(7, LinesDown, OppositePitch);
  const Vector3d up = survey.model_from_enu.rotation * Vector3d::UnitZ();
  EXPECT_EQ(VerdictOf(survey, up).use, GimbalUse::kDropped);
  EXPECT_NEAR(VerdictOf(survey, up).angle_deg, 180.0, 1.0);
  EXPECT_EQ(VerdictOf(survey, std::nullopt).use, GimbalUse::kDropped);
  survey.points.clear();
  EXPECT_EQ(VerdictOf(survey, up).use, GimbalUse::kDropped);
  EXPECT_EQ(VerdictOf(survey, std::nullopt).use, GimbalUse::kDoubted);
  // Tags that agree with the angles keep them.
  EXPECT_EQ(VerdictOf(survey, -up).use, GimbalUse::kUsed);
}

TEST(GimbalCheck, OtherWrongAnglesAreDroppedWhenTagsContradictThem) {
  const std::function<Attitude(int)> one_way = [](int) { return Attitude{.yaw_deg = 20.0}; };
  const std::function<Vector3d(const Attitude&)> kinds[] = {FromStraightDown, OppositePitch,
                                                            [](const Attitude&) { return prepare::input::UpInCamera(0.0, 0.0); },
                                                            [](const Attitude&) { return prepare::input::UpInCamera(-30.0, 60.0); }};
  uint64_t seed = 20;
  for (const auto& tagged : kinds) {
    const TaggedSurvey survey = MakeTagged(seed++, one_way, tagged);
    const Vector3d up = survey.model_from_enu.rotation * Vector3d::UnitZ();
    EXPECT_EQ(VerdictOf(survey, up).use, GimbalUse::kDropped) << seed;
  }
  const TaggedSurvey oblique = MakeTagged(
      10, [](int i) { return Attitude{.yaw_deg = 36.0 * i, .pitch_deg = -70.0}; }, OppositePitch);
  EXPECT_EQ(VerdictOf(oblique, oblique.model_from_enu.rotation * Vector3d::UnitZ()).use, GimbalUse::kDropped);
}

TEST(GimbalCheck, NoAnglesNoVerdict) {
  TaggedSurvey survey = MakeTagged(11, LinesDown, Right);
  for (prepare::input::PreparedPhoto& photo : survey.photos) photo.up_in_cam.reset();
  EXPECT_EQ(VerdictOf(survey, std::nullopt).use, GimbalUse::kUsed);
  EXPECT_EQ(JudgeGimbal({}, {}, [] { return std::nullopt; }).use, GimbalUse::kUsed);
}

TEST(FaultOfAngles, KnowsTheUsualOnes) {
  for (const double pitch_deg : {-90.0, -75.0, -55.0}) {
    const Vector3d found = prepare::input::UpInCamera(pitch_deg, 2.0);
    EXPECT_EQ(FaultOfAngles(prepare::input::UpInCamera(pitch_deg + 10.0, 0.0), found), GimbalFault::kNone);
    EXPECT_EQ(FaultOfAngles(prepare::input::UpInCamera(-pitch_deg, 2.0), found), GimbalFault::kOppositePitch);
    EXPECT_EQ(FaultOfAngles(prepare::input::UpInCamera(0.0, 0.0), found), GimbalFault::kAllZero);
    EXPECT_EQ(FaultOfAngles(prepare::input::UpInCamera(pitch_deg, 95.0), prepare::input::UpInCamera(-20.0, 0.0)), GimbalFault::kOther);
  }
  EXPECT_EQ(FaultOfAngles(prepare::input::UpInCamera(5.0, 2.0), prepare::input::UpInCamera(-85.0, 2.0)), GimbalFault::kFromStraightDown);
  // Level cameras may have all angles 0.
  EXPECT_EQ(FaultOfAngles(prepare::input::UpInCamera(0.0, 0.0), prepare::input::UpInCamera(3.0, 0.0)), GimbalFault::kNone);
}

}  // namespace
}  // namespace skyquilt::test
