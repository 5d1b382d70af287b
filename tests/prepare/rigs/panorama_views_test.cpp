#include "prepare/rigs/panorama_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "core/base/random.h"
#include "core/camera/equirectangular.h"
#include "prepare/poses/seed/seed_rotation.h"
#include "prepare/rigs/panorama_picture.h"

namespace skyquilt::prepare::rigs {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

camera::Camera SquareCamera(int width, double fov_deg) {
  const double focal_px = ViewFocal(width, fov_deg);
  return {camera::CameraModel::kPinhole, width, width, {focal_px, focal_px, 0.5 * width, 0.5 * width}};
}

TEST(PanoramaViews, ThreeRingsAreTwelveViewsOfDifferentNames) {
  const std::vector<PanoramaView> views = LayOutViews(4, {0.0, -35.0, 35.0});
  ASSERT_EQ(views.size(), 12U);
  std::set<std::string> prefixes;
  for (const PanoramaView& view : views) prefixes.insert(view.prefix);
  EXPECT_EQ(prefixes.size(), 12U);
  EXPECT_EQ(views[0].yaw_deg, 0.0);
  EXPECT_EQ(views[0].pitch_deg, 0.0);
  EXPECT_EQ(views[4].yaw_deg, 0.0);
  EXPECT_EQ(views[4].pitch_deg, -35.0);
  EXPECT_EQ(views[8].yaw_deg, 45.0);
  EXPECT_EQ(views[8].pitch_deg, 35.0);
}

TEST(PanoramaViews, ACubeHasSixFaces) {
  const std::vector<PanoramaView> views = LayOutViews(4, {-90.0, 0.0, 90.0});
  ASSERT_EQ(views.size(), 6U);
  const Eigen::Vector3d directions[] = {Eigen::Vector3d::UnitZ(),  Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitZ(),
                                        -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitY()};
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR((views[i].cam_from_pano.conjugate() * Eigen::Vector3d::UnitZ() - directions[i]).norm(), 0.0, 1e-12) << i;
  }
}

// Every direction that is not near the poles is in a view, and none of the usual ones shows what is straight below.
TEST(PanoramaViews, TheUsualOnesSeeAllButThePoles) {
  const std::vector<PanoramaView> views = LayOutViews(4, {0.0, -35.0, 35.0});
  const camera::Camera camera = SquareCamera(1000, 90.0);
  const camera::Equirectangular sphere{360, 180};
  for (int row = 0; row < 180; ++row) {
    for (int column = 0; column < 360; ++column) {
      const Eigen::Vector3d ray = sphere.RayFromImg({column + 0.5, row + 0.5});
      int n = 0;
      for (const PanoramaView& view : views) {
        const auto pixel = camera.ImgFromCam(view.cam_from_pano * ray);
        n += pixel && pixel->minCoeff() >= 0.0 && pixel->maxCoeff() <= 1000.0 ? 1 : 0;
      }
      const double elevation_deg = 89.5 - row;
      if (std::abs(elevation_deg) < 70.0) EXPECT_GE(n, 1) << column << " " << row;
      if (std::abs(elevation_deg) > 81.0) EXPECT_EQ(n, 0) << column << " " << row;
    }
  }
}

// By the formulas of the two projections written out.
TEST(PanoramaViews, RaysOfPixelsAreThoseOfThePanorama) {
  const camera::Camera camera = SquareCamera(640, 75.0);
  const double focal_px = 320.0 / std::tan(37.5 * kDegree);
  base::Random random(2);
  for (const PanoramaView& view : LayOutViews(5, {0.0, -40.0, 30.0, 90.0})) {
    const double yaw = view.yaw_deg * kDegree, pitch = view.pitch_deg * kDegree;
    for (int i = 0; i < 50; ++i) {
      const double x = random.Uniform(0.0, 640.0), y = random.Uniform(0.0, 640.0);
      const double right = (x - 320.0) / focal_px, up = (320.0 - y) / focal_px;
      // Turned up by the pitch, then right by the yaw.
      const double ahead = std::cos(pitch) - up * std::sin(pitch), above = std::sin(pitch) + up * std::cos(pitch);
      const Eigen::Vector3d expected =
          Eigen::Vector3d(right * std::cos(yaw) + ahead * std::sin(yaw), -above, ahead * std::cos(yaw) - right * std::sin(yaw)).normalized();
      EXPECT_LT((PanoramaRay(camera, view.cam_from_pano, {x, y}) - expected).norm(), 1e-6);
    }
  }
}

TEST(PanoramaViews, TheRigHasOneCentreAndTheFirstViewsFrame) {
  const std::vector<PanoramaView> views = LayOutViews(4, {0.0, -35.0});
  const Rig rig = RigOf(views);
  ASSERT_EQ(rig.cameras.size(), views.size());
  EXPECT_TRUE(rig.cameras[0].cam_from_rig.rotation.isApprox(Eigen::Quaterniond::Identity(), 1e-12));
  for (size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(rig.cameras[i].cam_from_rig.translation.norm(), 0.0);
    const Eigen::Quaterniond from_first = rig.cameras[i].cam_from_rig.rotation * views[0].cam_from_pano;
    EXPECT_LT(from_first.angularDistance(views[i].cam_from_pano), 1e-7);
  }
}

TEST(PanoramaViews, AnglesAreThoseThatMakeTheRotation) {
  base::Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double yaw = random.Uniform(-179.0, 179.0), pitch = random.Uniform(-89.0, 89.0), roll = random.Uniform(-170.0, 170.0);
    const Angles angles = AnglesOf(poses::RotationFromAngles(yaw, pitch, roll));
    EXPECT_NEAR(angles.yaw_deg, yaw, 1e-6);
    EXPECT_NEAR(angles.pitch_deg, pitch, 1e-6);
    EXPECT_NEAR(angles.roll_deg, roll, 1e-6);
  }
  for (const double pitch : {-90.0, 90.0}) {
    const Eigen::Quaterniond rotation = poses::RotationFromAngles(33.0, pitch, 0.0);
    const Angles angles = AnglesOf(rotation);
    EXPECT_LT(poses::RotationFromAngles(angles.yaw_deg, angles.pitch_deg, angles.roll_deg).angularDistance(rotation), 1e-6);
  }
}

TEST(PanoramaViews, TagsFollowFromThePanoramas) {
  survey::PhotoTags panorama;
  panorama.gps = geo::Geodetic{47.0, 8.0, 500.0};
  panorama.capture_time_s = 1000.5;
  panorama.exposure = {0.01, 2.0, 100.0};
  panorama.gimbal_pitch_deg = -12.0;  // of the camera that took the parts
  panorama.panorama = survey::PanoramaTags{.heading_deg = 350.0};
  const std::vector<PanoramaView> views = LayOutViews(4, {0.0, -35.0});
  const survey::PhotoTags tags = TagsOfView(panorama, views[5], 1000, 500.0);
  EXPECT_EQ(tags.gps->latitude_deg, 47.0);
  EXPECT_EQ(tags.capture_time_s, 1000.5);
  EXPECT_EQ(tags.exposure.time_s, 0.01);
  EXPECT_NEAR(*tags.gimbal_yaw_deg, 80.0, 1e-9);
  EXPECT_NEAR(*tags.gimbal_pitch_deg, -35.0, 1e-9);
  EXPECT_NEAR(*tags.gimbal_roll_deg, 0.0, 1e-9);
  EXPECT_EQ(tags.calibrated_focal_px, 500.0);
  EXPECT_FALSE(tags.panorama);
  // A panorama that leans to the right by 10 degrees: the view to its right looks down.
  panorama.panorama = survey::PanoramaTags{.heading_deg = {}, .pitch_deg = 0.0, .roll_deg = 10.0};
  const survey::PhotoTags leaning = TagsOfView(panorama, views[1], 1000, 500.0);
  EXPECT_FALSE(leaning.gimbal_yaw_deg);
  EXPECT_NEAR(*leaning.gimbal_pitch_deg, -10.0, 1e-9);
  panorama.panorama = survey::PanoramaTags{};
  EXPECT_FALSE(TagsOfView(panorama, views[1], 1000, 500.0).gimbal_pitch_deg);
}

TEST(PanoramaViews, WidthKeepsThePanoramasSharpness) {
  const int width = WidthAsSharp(8192, 90.0);
  EXPECT_EQ(width % 2, 0);
  // Pixels per radian in the middle of the view and on the horizon.
  EXPECT_NEAR(ViewFocal(width, 90.0), 8192.0 / (2.0 * std::numbers::pi), 1.0);
}

}  // namespace
}  // namespace skyquilt::prepare::rigs
