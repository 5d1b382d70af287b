#include "simulate/pose_noise.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/geo/pose_gauge.h"
#include "core/survey/refined_poses.h"
#include "simulate/survey_writer.h"

namespace skyquilt::simulate {
namespace {

TEST(PoseNoise, HasItsSizeAndLeavesPhotosWithTrueDepthAndTheWholeInPlace) {
  std::vector<PhotoPlan> photos(160);
  for (size_t i = 0; i < photos.size(); ++i) {
    photos[i].true_depth = i % 8 == 0;
    const Eigen::Vector3d centre(20.0 * static_cast<double>(i % 16), 20.0 * static_cast<double>(i / 16), 80.0);
    const geo::Rigid3d enu_from_cam{geo::RotationOfVector({std::numbers::pi, 0.0, 0.1 * static_cast<double>(i % 7)}), centre};
    photos[i].cam_from_enu = enu_from_cam.Inverse();
  }
  const survey::ColmapModel exact = MakeModel({}, photos, {});
  survey::ColmapModel noisy = exact, again = exact, none = exact;
  AddPoseNoise(0.2, 0.3, 5, photos, noisy);
  AddPoseNoise(0.2, 0.3, 5, photos, again);
  AddPoseNoise(0.0, 0.0, 5, photos, none);
  double turned = 0.0, shifted = 0.0;
  std::vector<geo::Rigid3d> given, changed;
  for (size_t i = 0; i < photos.size(); ++i) {
    EXPECT_EQ(noisy.images[i].cam_from_world.translation, again.images[i].cam_from_world.translation);
    EXPECT_EQ(none.images[i].cam_from_world.translation, exact.images[i].cam_from_world.translation);
    if (photos[i].true_depth) {
      EXPECT_EQ(noisy.images[i].cam_from_world.translation, exact.images[i].cam_from_world.translation) << i;
      continue;
    }
    given.push_back(exact.images[i].cam_from_world.Inverse());
    changed.push_back(noisy.images[i].cam_from_world.Inverse());
    const survey::PoseOffset offset = survey::OffsetBetween(given.back(), changed.back());
    turned += offset.rotation.squaredNorm();
    shifted += offset.translation.squaredNorm();
  }
  EXPECT_NEAR(180.0 / std::numbers::pi * std::sqrt(turned / 140.0), 0.2, 0.03);
  EXPECT_NEAR(std::sqrt(shifted / 140.0), 0.3, 0.04);
  const std::vector<double> weights(given.size(), 1.0);
  const geo::Similarity3d common = geo::SmallSimilarity(given, changed, weights, 80.0);
  const Eigen::Vector3d far(300.0, 0.0, 0.0);
  EXPECT_LT((common * far - far).norm(), 1e-3);
}

}  // namespace
}  // namespace skyquilt::simulate
