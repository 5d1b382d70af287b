#include "prepare/poses/seed/seed_rotation.h"

#include <gtest/gtest.h>

#include "prepare/input/prepared_photo.h"
#include "prepare/poses/seed/seed_survey.h"
#include "tests/prepare/poses/seed/made_survey.h"

namespace skyquilt::test {
namespace {

using namespace prepare::poses;

TEST(RotationFromAngles, HasTheUpOfTheGimbal) {
  for (const double yaw : {0.0, 77.0, 200.0}) {
    for (const double pitch : {-90.0, -60.0, 0.0}) {
      for (const double roll : {0.0, 12.0, -5.0}) {
        const Eigen::Vector3d up = RotationFromAngles(yaw, pitch, roll) * Eigen::Vector3d::UnitZ();
        EXPECT_LT((up - prepare::input::UpInCamera(pitch, roll)).norm(), 1e-12);
      }
    }
  }
  // Facing east, level: the axis points east, the right side south.
  const Eigen::Quaterniond east = RotationFromAngles(90.0, 0.0, 0.0);
  EXPECT_LT((east * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((east * -Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(RotationsLookingDown, FindsTheTurnOfEveryPhoto) {
  const MadeSurvey made = MakeSurvey({.angle_noise_deg = 0.0, .wrong_matches = 0.1, .tilt_noise_deg = 3.0});
  SeedSurvey survey;
  std::string reason;
  ASSERT_TRUE(MakeSeedSurvey(made.input, &survey, &reason)) << reason;
  std::vector<SeedView> views;
  for (const prepare::bundle::BundlePhoto& photo : survey.photos) views.push_back({true, Eigen::Quaterniond::Identity(), *photo.gps});
  const auto rotations = RotationsLookingDown(survey.rays, views);
  for (size_t i = 0; i < rotations.size(); ++i) {
    ASSERT_TRUE(rotations[i]);
    // A tilt of 3 degrees looks like a motion of 5 m from this height, and photos in the corners have few neighbours.
    const Eigen::Quaterniond truth = RotationFromAngles(made.angles_deg[i].x(), -90.0, 0.0);
    EXPECT_LT(rotations[i]->angularDistance(truth) * 180.0 / M_PI, 8.0) << made.input.photos[i].name;
  }
}

TEST(CheckGround, FindsHeightAndTurn) {
  const MadeSurvey made = MakeSurvey({.gps_noise_m = 0.5, .angle_noise_deg = 1.0});
  SeedSurvey survey;
  std::string reason;
  ASSERT_TRUE(MakeSeedSurvey(made.input, &survey, &reason)) << reason;
  std::vector<SeedView> views;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    // All turned by 0.5 the wrong way.
    views.push_back({true, Turned(made.cam_from_enu[i].rotation, -0.5), *survey.photos[i].gps});
  }
  const GroundCheck check = CheckGround(survey.rays, views);
  EXPECT_NEAR(check.turn_rad, 0.5, 0.05);
  // The focal length is 6 % too long, so the ground seems that much lower.
  EXPECT_NEAR(check.height_m, 80.0 * 1.06, 5.0);
  EXPECT_GT(check.share_agreeing, 0.95);
  // Every photo turned by another angle.
  for (size_t i = 0; i < views.size(); ++i) views[i].cam_from_enu = Turned(views[i].cam_from_enu, 1.3 * static_cast<double>(i));
  EXPECT_LT(CheckGround(survey.rays, views).share_agreeing, 0.3);
}

}  // namespace
}  // namespace skyquilt::test
