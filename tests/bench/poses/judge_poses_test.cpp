#include "bench/poses/judge_poses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace skyquilt::bench {
namespace {

constexpr double kHeight_m = 50.0;
constexpr double kFocal_px = 500.0;

// Three lines of four photos that look straight down, and an intruder.
TrueSet Flight() {
  TrueSet set;
  set.height_m = kHeight_m;
  const Eigen::Quaterniond down(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d centre(20.0 * (i % 4), 25.0 * (i / 4), kHeight_m + 0.3 * (i % 3));
    set.photos.push_back({"IMG_" + std::to_string(100 + i) + ".jpg", {down, -(down * centre)}, kFocal_px, false});
  }
  set.photos.push_back({"OTHER.jpg", {}, kFocal_px, true});
  return set;
}

// All own photos, in a frame that is moved, turned and scaled.
survey::ColmapModel ModelOf(const TrueSet& set, double focal_px = kFocal_px) {
  const geo::Similarity3d model_from_enu{0.1, Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 2, 3).normalized())), {5.0, -3.0, 2.0}};
  survey::ColmapModel model;
  model.cameras[1] = {camera::CameraModel::kPinhole, 640, 480, {focal_px, focal_px, 320.0, 240.0}};
  for (const TruePhoto& photo : set.photos) {
    if (photo.intruder) continue;
    model.images.push_back(
        {static_cast<uint32_t>(model.images.size() + 1), 1, photo.name, geo::TransformCameraWorld(photo.cam_from_enu, model_from_enu)});
  }
  return model;
}

void MoveCentre(survey::ColmapImage& image, const Eigen::Vector3d& by_in_cam) {
  image.cam_from_world.translation -= by_in_cam;
}

TEST(JudgePoses, TheTruthIsRightInAnyFrame) {
  const TrueSet set = Flight();
  const PoseScore score = JudgePoses(set, ModelOf(set, 1.1 * kFocal_px));
  EXPECT_EQ(score.n_photos, 12U);
  EXPECT_EQ(score.registered, 12U);
  EXPECT_EQ(score.right, 12U);
  EXPECT_EQ(score.intruders, 0U);
  EXPECT_LT(score.position_m, 1e-9);
  EXPECT_LT(score.rotation_deg, 1e-5);
  EXPECT_NEAR(score.focal_error, 0.1, 1e-12);
  EXPECT_EQ(score.problem, "");
}

TEST(JudgePoses, OnePhotoInAWrongPlaceIsWrongAloneAndSoIsOneTurned) {
  const TrueSet set = Flight();
  survey::ColmapModel model = ModelOf(set);
  // 1.2 m, more than 2 % of the height, which is 0.12 in the model's units.
  MoveCentre(model.images[2], {0.12, 0.0, 0.0});
  geo::Rigid3d& turned = model.images[7].cam_from_world;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.5 * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ()));
  turned = {turn * turned.rotation, turn * turned.translation};
  EXPECT_EQ(JudgePoses(set, model).right, 10U);
  EXPECT_EQ(JudgePoses(set, model).registered, 12U);
  MoveCentre(model.images[2], {-0.12, 0.0, 0.0});
  EXPECT_EQ(JudgePoses(set, model).right, 11U);
}

TEST(JudgePoses, IntrudersAndStrangersAreNotCounted) {
  const TrueSet set = Flight();
  survey::ColmapModel model = ModelOf(set);
  model.images.resize(9);
  model.images.push_back({20, 1, "OTHER.jpg", {}});
  model.images.push_back({21, 1, "unknown.jpg", {}});
  const PoseScore score = JudgePoses(set, model);
  EXPECT_EQ(score.registered, 9U);
  EXPECT_EQ(score.right, 9U);
  EXPECT_EQ(score.intruders, 1U);
}

TEST(JudgePoses, TooFewPosesHaveNoFrame) {
  const TrueSet set = Flight();
  survey::ColmapModel model = ModelOf(set);
  model.images.resize(2);
  const PoseScore score = JudgePoses(set, model);
  EXPECT_EQ(score.registered, 2U);
  EXPECT_EQ(score.right, 0U);
  EXPECT_NE(score.problem, "");
  EXPECT_TRUE(std::isnan(score.position_m));
  EXPECT_TRUE(std::isnan(JudgePoses(set, {}).focal_error));
}

}  // namespace
}  // namespace skyquilt::bench
