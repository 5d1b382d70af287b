#include "simulate/flights/panorama_flight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/camera/equirectangular.h"
#include "core/survey/exif.h"
#include "simulate/photo_renderer.h"
#include "simulate/simulate_options.h"
#include "simulate/survey_writer.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::simulate {
namespace {

class PanoramaFlight : public InTemporaryFolder {
 protected:
  const PlaceSpec place_ = ResolvePlace({.place = "hamlet"});
  const std::vector<PhotoPlan> photos_ = PlanFlight(place_, 0.0);
};

TEST_F(PanoramaFlight, IsLevelAtPlacesOfTheFlight) {
  const std::vector<PhotoPlan> plans = PlanPanoramas(photos_, 5);
  ASSERT_EQ(plans.size(), 5U);
  EXPECT_EQ(plans.front().name, "PANO_0001.jpg");
  for (const PhotoPlan& plan : plans) {
    EXPECT_FALSE(plan.oblique);
    // Its middle looks level to where the photo's yaw points.
    const Eigen::Vector3d ahead = plan.cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(ahead.z(), 0.0, 1e-12);
    EXPECT_NEAR(std::remainder(std::atan2(ahead.x(), ahead.y()) * 180.0 / M_PI - plan.yaw_deg, 360.0), 0.0, 1e-9);
    const bool at_a_photo = std::any_of(photos_.begin(), photos_.end(), [&](const PhotoPlan& photo) {
      return (photo.cam_from_enu.OriginInSource() - plan.cam_from_enu.OriginInSource()).norm() < 1e-9;
    });
    EXPECT_TRUE(at_a_photo);
  }
  EXPECT_EQ(PlanPanoramas({photos_.begin(), photos_.begin() + 2}, 5).size(), 2U);
}

// Traced by direction, a panorama shows along a pixel's ray what a photo shows along the same ray.
TEST_F(PanoramaFlight, ShowsWhatPhotosShow) {
  base::ThreadPool threads(2);
  const World world(place_, 1.0, threads);
  const PhotoPlan plan = PlanPanoramas(photos_, 3)[1];
  const camera::Equirectangular sphere{256, 128};
  const camera::Camera camera{camera::CameraModel::kPinhole, 65, 65, {60.0, 60.0, 32.5, 32.5}};
  const Rendering panorama = PhotoRenderer(world, sphere, 1, false).Render(plan.cam_from_enu, world.MovingAt(0.0), threads);
  base::Random random(1);
  int n_same = 0;
  constexpr int kPixels = 12;
  for (int i = 0; i < kPixels; ++i) {
    const int x = static_cast<int>(random.Below(256)), y = 64 + static_cast<int>(random.Below(60));
    // A photo whose middle pixel looks along the panorama's pixel.
    const Eigen::Vector3d ray = sphere.RayFromImg({x + 0.5, y + 0.5});
    geo::Rigid3d pose;
    pose.rotation = Eigen::Quaterniond::FromTwoVectors(ray, Eigen::Vector3d::UnitZ()) * plan.cam_from_enu.rotation;
    pose.translation = -(pose.rotation * plan.cam_from_enu.OriginInSource());
    const Rendering photo = PhotoRenderer(world, camera, 1, false).Render(pose, world.MovingAt(0.0), threads);
    const Eigen::Map<const Eigen::Vector3f> expected(photo.rgb_linear.At(32, 32)), found(panorama.rgb_linear.At(x, y));
    // Textures are filtered over a pixel's angle, which differs a little.
    n_same += (found - expected).norm() < 0.05F * expected.norm() + 0.01F ? 1 : 0;
  }
  EXPECT_GE(n_same, kPixels - 2);
}

TEST_F(PanoramaFlight, TagsSayHeadingPlaceAndThatItIsAPanorama) {
  const PhotoPlan plan = PlanPanoramas(photos_, 4)[2];
  const geo::EnuFrame frame({47.0, 8.0, 400.0});
  WritePanorama(plan, image::Image8(64, 32, 3, 100), place_.camera, frame, 90, folder_.path());
  const survey::PhotoTags tags = survey::ReadPhotoTags(folder_ / plan.name);
  ASSERT_TRUE(tags.panorama);
  EXPECT_NEAR(std::remainder(*tags.panorama->heading_deg - plan.tagged_gimbal->yaw_deg, 360.0), 0.0, 0.01);
  EXPECT_EQ(tags.panorama->full_width, 64);
  ASSERT_TRUE(tags.gps);
  EXPECT_NEAR((frame.EnuFromGeodetic(*tags.gps) - plan.tagged_position).norm(), 0.0, 0.02);
  EXPECT_FALSE(tags.gimbal_pitch_deg);
  EXPECT_FALSE(tags.focal_length_35mm);
}

TEST_F(PanoramaFlight, OddWidthsAreRefused) {
  SimulateOptions options;
  options.panorama_width = 101;
  EXPECT_NE(ErrorOf<base::UsageError>([&] { options.Check(); }).find("panorama_width"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::simulate
