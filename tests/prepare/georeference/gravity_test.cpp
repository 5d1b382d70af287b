#include "prepare/georeference/gravity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>

#include "tests/prepare/georeference/lawnmower_photos.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector3d;
using test::AngleDeg;
using test::Attitude;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr int kCameras = 40;

struct Attempt {
  geo::Similarity3d model_from_enu;
  std::vector<input::PreparedPhoto> photos = {};

  Vector3d Up() const { return model_from_enu.rotation * Vector3d::UnitZ(); }
};

// Cameras on a lawnmower, with the gimbal angles of their attitudes.
Attempt MakeAttempt(uint64_t seed, const std::function<Attitude(int)>& attitude) {
  base::Random random(seed);
  Attempt attempt{.model_from_enu = test::RandomFrame(random)};
  for (int i = 0; i < kCameras; ++i) {
    const Attitude a = attitude(i);
    attempt.photos.push_back(test::PreparedAt(test::OnLawnmower(i, kCameras), a, attempt.model_from_enu));
    attempt.photos.back().up_in_cam = input::UpInCamera(a.pitch_deg, a.roll_deg);
  }
  return attempt;
}

Attitude NadirLines(int i) {
  return {.yaw_deg = (i / test::kLine) % 2 == 0 ? 20.0 : 200.0};
}

void WithoutAngles(std::vector<input::PreparedPhoto>& photos) {
  for (input::PreparedPhoto& photo : photos) photo.up_in_cam.reset();
}

// Ground below the lawnmower that rises towards the east by `slope_deg`.
std::vector<Vector3d> Ground(const geo::Similarity3d& model_from_enu, double slope_deg, double roughness_m) {
  base::Random random(77);
  std::vector<Vector3d> points;
  for (int i = 0; i < 800; ++i) {
    const double east_m = random.Uniform(-100.0, 100.0), north_m = random.Uniform(-100.0, 100.0);
    points.push_back(model_from_enu * Vector3d(east_m, north_m, east_m * std::tan(slope_deg / kDegrees) + roughness_m * random.Normal()));
  }
  return points;
}

TEST(UpInCamera, AgreesWithTheCamerasRotation) {
  for (const double yaw_deg : {0.0, 77.0, 210.0}) {
    for (const double pitch_deg : {-90.0, -63.0, -30.0, 0.0, 15.0}) {
      for (const double roll_deg : {-40.0, 0.0, 3.0, 180.0}) {
        const Vector3d up = test::CamFromEnu({yaw_deg, pitch_deg, roll_deg}) * Vector3d::UnitZ();
        EXPECT_LT((input::UpInCamera(pitch_deg, roll_deg) - up).norm(), 1e-12) << yaw_deg << " " << pitch_deg << " " << roll_deg;
      }
    }
  }
}

TEST(GimbalEvidence, ExactAnglesGiveTheExactUp) {
  const std::function<Attitude(int)> kinds[] = {
      NadirLines, [](int i) { return Attitude{.yaw_deg = 36.0 * i, .pitch_deg = -45.0}; },
      [](int i) { return Attitude{.yaw_deg = 50.0 * i, .pitch_deg = i % 3 == 0 ? -90.0 : -30.0 - i, .roll_deg = 2.0 * std::sin(i)}; },
      [](int) { return Attitude{.yaw_deg = 120.0, .pitch_deg = -60.0}; }};
  uint64_t seed = 1;
  for (const auto& kind : kinds) {
    const Attempt attempt = MakeAttempt(seed++, kind);
    const std::vector<UpEvidence> evidence = GimbalEvidence(attempt.photos);
    ASSERT_EQ(evidence.size(), 1U);
    EXPECT_EQ(evidence[0].kind, "gimbal");
    EXPECT_EQ(evidence[0].n, kCameras);
    EXPECT_LT(AngleDeg(evidence[0].up, attempt.Up()), 0.01) << seed;
  }
}

TEST(GimbalEvidence, ACommonErrorCancelsWithOppositeHeadings) {
  for (const double common_deg : {0.3, 1.0}) {
    Attempt attempt = MakeAttempt(2, NadirLines);
    base::Random random(3);
    const Eigen::Quaterniond common(Eigen::AngleAxisd(common_deg / kDegrees, Vector3d(0.8, 0.6, 0.0)));
    for (input::PreparedPhoto& photo : attempt.photos) photo.up_in_cam = common * (test::SmallRotation(0.5, random) * *photo.up_in_cam);
    const UpEvidence evidence = GimbalEvidence(attempt.photos).at(0);
    EXPECT_LT(AngleDeg(evidence.up, attempt.Up()), 0.25);
    EXPECT_LT(evidence.Sigma() * kDegrees, 0.25);
  }
}

TEST(GimbalEvidence, TheStatedAccuracyCoversACommonErrorWithOneHeading) {
  double errors = 0.0, stated = 0.0;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    Attempt attempt = MakeAttempt(seed, [](int) { return Attitude{.yaw_deg = 70.0}; });
    base::Random random(seed, 1);
    const Eigen::Quaterniond common = test::SmallRotation(kGimbalCommon_deg, random);
    for (input::PreparedPhoto& photo : attempt.photos) photo.up_in_cam = common * (test::SmallRotation(0.5, random) * *photo.up_in_cam);
    const UpEvidence evidence = GimbalEvidence(attempt.photos).at(0);
    errors += std::pow(AngleDeg(evidence.up, attempt.Up()), 2);
    stated += std::pow(evidence.Sigma() * kDegrees, 2);
  }
  EXPECT_GT(std::sqrt(errors / stated), 0.5);
  EXPECT_LT(std::sqrt(errors / stated), 1.6);
}

TEST(GimbalEvidence, WrongAnglesDoNotPull) {
  Attempt attempt = MakeAttempt(5, NadirLines);
  base::Random random(6);
  for (size_t i = 0; i < attempt.photos.size(); ++i) {
    Vector3d& up = *attempt.photos[i].up_in_cam;
    up = i % 5 == 3 ? Vector3d{random.Normal(), random.Normal(), random.Normal()}.normalized() : Vector3d(test::SmallRotation(0.3, random) * up);
  }
  EXPECT_LT(AngleDeg(GimbalEvidence(attempt.photos).at(0).up, attempt.Up()), 0.2);
}

TEST(GimbalEvidence, IsEmptyWithoutAnglesOrWhenTheyCancel) {
  Attempt attempt = MakeAttempt(7, NadirLines);
  for (size_t i = 0; i < attempt.photos.size(); i += 2) *attempt.photos[i].up_in_cam *= -1.0;
  EXPECT_TRUE(GimbalEvidence(attempt.photos).empty());
  WithoutAngles(attempt.photos);
  EXPECT_TRUE(GimbalEvidence(attempt.photos).empty());
  EXPECT_TRUE(GimbalEvidence({}).empty());
}

TEST(CameraEvidence, LevelCamerasAllAroundGiveUp) {
  const Attempt attempt = MakeAttempt(8, [](int i) { return Attitude{.yaw_deg = 27.0 * i, .pitch_deg = -40.0}; });
  const std::vector<UpEvidence> evidence = CameraEvidence(attempt.photos);
  ASSERT_EQ(evidence.size(), 1U);
  EXPECT_EQ(evidence[0].kind, "cameras");
  EXPECT_LT(AngleDeg(evidence[0].up, attempt.Up()), 0.01);
}

TEST(CameraEvidence, NadirLinesGiveUpWhateverTheirMounting) {
  const Attempt exact = MakeAttempt(9, NadirLines);
  EXPECT_LT(AngleDeg(CameraEvidence(exact.photos).at(0).up, exact.Up()), 0.01);
  // A camera mounted askew leans forward on the way out and back on the way home.
  const Attempt mounted = MakeAttempt(10, [](int i) {
    return Attitude{NadirLines(i).yaw_deg, -88.5 + 0.5 * std::sin(11.0 * i), 0.5 * std::cos(7.0 * i)};
  });
  const UpEvidence evidence = CameraEvidence(mounted.photos).at(0);
  EXPECT_LT(AngleDeg(evidence.up, mounted.Up()), 0.2);
  // With one heading the mounting stays unknown, and the stated accuracy says so.
  const Attempt one_way = MakeAttempt(11, [](int) { return Attitude{.yaw_deg = 70.0}; });
  EXPECT_GT(CameraEvidence(one_way.photos).at(0).Sigma() * kDegrees, kCameraCommon_deg);
  EXPECT_LT(evidence.Sigma() * kDegrees, 0.5 * kCameraCommon_deg);
}

TEST(GroundEvidence, FindsALeaningPlaneDespiteFarPoints) {
  base::Random random(12);
  const geo::Similarity3d model_from_enu = test::RandomFrame(random);
  const Vector3d normal = model_from_enu.rotation * Vector3d(-std::sin(8.0 / kDegrees), 0.0, std::cos(8.0 / kDegrees));
  std::vector<Vector3d> points = Ground(model_from_enu, 8.0, 1.0);
  for (size_t i = 0; i < points.size(); i += 6) points[i] = model_from_enu * Vector3d{2000.0 * random.Normal(), 2000.0 * random.Normal(), 3000.0};
  for (const double side : {1.0, -1.0}) {
    const std::vector<UpEvidence> evidence = GroundEvidence(points, side * (model_from_enu.rotation * Vector3d::UnitZ()));
    ASSERT_EQ(evidence.size(), 1U);
    EXPECT_EQ(evidence[0].kind, "ground");
    EXPECT_LT(AngleDeg(evidence[0].up, side * normal), 0.3);
    EXPECT_NEAR(evidence[0].Sigma() * kDegrees, kGroundSlope_deg, 0.2);
  }
}

TEST(GroundEvidence, SaysNothingWithoutAPlane) {
  base::Random random(13);
  const geo::Similarity3d model_from_enu = test::RandomFrame(random);
  std::vector<Vector3d> few = Ground(model_from_enu, 0.0, 1.0);
  few.resize(29);
  EXPECT_TRUE(GroundEvidence(few, Vector3d::UnitZ()).empty());
  std::vector<Vector3d> line, ball;
  for (int i = 0; i < 200; ++i) {
    line.emplace_back(model_from_enu * Vector3d(i, 0.5 * i, 0.0));
    ball.push_back({random.Normal(), random.Normal(), random.Normal()});
  }
  EXPECT_TRUE(GroundEvidence(line, Vector3d::UnitZ()).empty());
  EXPECT_TRUE(GroundEvidence(ball, Vector3d::UnitZ()).empty());
  EXPECT_TRUE(GroundEvidence(std::vector<Vector3d>(100, Vector3d(1.0, 2.0, 3.0)), Vector3d::UnitZ()).empty());
  EXPECT_TRUE(GroundEvidence({}, Vector3d::UnitZ()).empty());
}

TEST(FindGravity, AHillPullsOnlyWithoutGimbalAngles) {
  Attempt attempt = MakeAttempt(14, NadirLines);
  const std::vector<Vector3d> points = Ground(attempt.model_from_enu, 8.0, 1.0);
  const Gravity gimbal = FindGravity(attempt.photos, points);
  EXPECT_LT(AngleDeg(gimbal.up, attempt.Up()), 0.1);
  EXPECT_LT(gimbal.Sigma() * kDegrees, 0.3);
  ASSERT_EQ(gimbal.evidence.size(), 3U);
  for (const UpEvidence& evidence : gimbal.evidence) EXPECT_EQ(evidence.used, evidence.kind != "cameras");

  WithoutAngles(attempt.photos);
  const Gravity cameras = FindGravity(attempt.photos, points);
  const double error_deg = AngleDeg(cameras.up, attempt.Up());
  EXPECT_LT(error_deg, 2.0);
  EXPECT_LT(error_deg, 1.96 * cameras.Sigma() * kDegrees);
  EXPECT_GT(cameras.Sigma(), gimbal.Sigma());
}

TEST(FindGravity, FewGimbalAnglesJoinTheCameras) {
  Attempt attempt = MakeAttempt(15, NadirLines);
  for (size_t i = 0; i < attempt.photos.size(); ++i) {
    if (i % 3 != 0) attempt.photos[i].up_in_cam.reset();
  }
  const Gravity gravity = FindGravity(attempt.photos, {});
  ASSERT_EQ(gravity.evidence.size(), 2U);
  EXPECT_TRUE(gravity.evidence[0].used && gravity.evidence[1].used);
  EXPECT_LT(AngleDeg(gravity.up, attempt.Up()), 0.01);
}

TEST(FindGravity, WithoutPhotosNothingIsKnown) {
  const Gravity gravity = FindGravity({}, {});
  EXPECT_TRUE(gravity.evidence.empty());
  EXPECT_EQ(gravity.up, Vector3d::UnitZ());
  EXPECT_TRUE(std::isinf(gravity.Sigma()));
}

TEST(FindGravity, CamerasTurnedAtRandomAreNotTrusted) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    base::Random random(seed);
    std::vector<input::PreparedPhoto> photos(30);
    for (input::PreparedPhoto& photo : photos) {
      photo.cam_from_model.rotation = Eigen::Quaterniond{random.Normal(), random.Normal(), random.Normal(), random.Normal()}.normalized();
    }
    EXPECT_GT(FindGravity(photos, {}).Sigma() * kDegrees, 5.0) << seed;
  }
}

TEST(FindGravity, EvidenceThatContradictsItselfWidensTheResult) {
  Attempt attempt = MakeAttempt(16, NadirLines);
  const double agreeing = FindGravity(attempt.photos, Ground(attempt.model_from_enu, 0.0, 1.0)).Sigma();
  WithoutAngles(attempt.photos);
  const double level = FindGravity(attempt.photos, Ground(attempt.model_from_enu, 0.0, 1.0)).Sigma();
  const double steep = FindGravity(attempt.photos, Ground(attempt.model_from_enu, 25.0, 1.0)).Sigma();
  EXPECT_GT(level, agreeing);
  EXPECT_GT(steep, 1.5 * level);
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
