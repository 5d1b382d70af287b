#include "evaluate/photos/resect_photo.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/nadir_photo.h"

namespace skyquilt::evaluate::photos {
namespace {

using Eigen::Vector3d;

// Hilly, patterned ground, seen from 30 m.
std::vector<render::RayColor> Rendered(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu) {
  const geo::Rigid3d enu_from_cam = cam_from_enu.Inverse();
  std::vector<render::RayColor> colors(static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vector3d direction = enu_from_cam.rotation * camera.RayFromImg({x + 0.5, y + 0.5});
      double t = -enu_from_cam.translation.z() / direction.z();
      for (int round = 0; round < 6; ++round) {
        const Vector3d p = enu_from_cam.translation + t * direction;
        t = (3.0 * std::sin(0.2 * p.x()) * std::sin(0.15 * p.y()) - enu_from_cam.translation.z()) / direction.z();
      }
      const Vector3d p = enu_from_cam.translation + t * direction;
      render::RayColor& color = colors[static_cast<size_t>(y) * static_cast<size_t>(camera.width) + static_cast<size_t>(x)];
      for (int c = 0; c < 3; ++c) {
        color.rgb_srgb[c] =
            static_cast<float>(0.5 + 0.25 * std::sin(0.7 * p.x() + c) * std::cos(0.6 * p.y()) + 0.15 * std::sin(0.3 * (p.x() + p.y())));
      }
    }
  }
  return colors;
}

HeldOutPhoto Photo() {
  HeldOutPhoto task;
  task.camera.width = 60;
  task.camera.height = 45;
  task.camera.params = {50.0, 50.0, 30.0, 22.5};
  task.cam_from_enu = NadirPhoto({1.0, -2.0, 30.0}, "p.jpg").cam_from_enu;
  task.photo = image::Image8(60, 45, 3);
  const std::vector<render::RayColor> colors = Rendered(task.camera, task.cam_from_enu);
  for (size_t i = 0; i < colors.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) task.photo.data[3 * i + c] = static_cast<uint8_t>(std::lround(255.0F * colors[i].rgb_srgb[c]));
  }
  return task;
}

TEST(ResectPhoto, FindsThePoseThatThePhotoWasTakenFrom) {
  HeldOutPhoto task = Photo();
  const geo::Rigid3d truth = task.cam_from_enu;
  const survey::PoseOffset error{{0.006, -0.008, 0.01}, {0.3, -0.2, 0.25}};
  task.cam_from_enu = survey::WithOffset(truth.Inverse(), error).Inverse();
  const image::Image8 scored(60, 45, 1, 1);
  const ResectedPhoto found = ResectPhoto(task, scored, Rendered(task.camera, task.cam_from_enu), 30.0, Rendered);
  EXPECT_GT(found.resected_db, found.given_db + 10.0);
  EXPECT_GT(found.moved_px, 0.3);
  const survey::PoseOffset left = survey::OffsetBetween(truth.Inverse(), survey::WithOffset(task.cam_from_enu.Inverse(), found.offset));
  EXPECT_LT(left.rotation.norm(), 0.2 * error.rotation.norm());
  EXPECT_LT(left.translation.norm(), 0.2 * error.translation.norm());
}

TEST(ResectPhoto, LeavesARightPoseAndDoesNotLookAtTheTilesThatItScores) {
  HeldOutPhoto task = Photo();
  const image::Image8 scored(60, 45, 1, 1);
  const std::vector<render::RayColor> as_given = Rendered(task.camera, task.cam_from_enu);
  const ResectedPhoto right = ResectPhoto(task, scored, as_given, 30.0, Rendered);
  EXPECT_LT(right.moved_px, 0.05);
  EXPECT_NEAR(right.resected_db, right.given_db, 1.0);
  // What the scored tiles show changes the scores and not the pose.
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      if ((x / 16 + y / 16) % 2 == 1) std::fill_n(task.photo.At(x, y), 3, uint8_t{255});
    }
  }
  const ResectedPhoto other = ResectPhoto(task, scored, as_given, 30.0, Rendered);
  EXPECT_EQ(other.offset.rotation, right.offset.rotation);
  EXPECT_EQ(other.offset.translation, right.offset.translation);
  EXPECT_LT(other.given_db, right.given_db - 10.0);
}

TEST(ResectPhoto, OfNothingIsNotMeasured) {
  const HeldOutPhoto task = Photo();
  const image::Image8 none(60, 45, 1, 0);
  const ResectedPhoto found = ResectPhoto(task, none, Rendered(task.camera, task.cam_from_enu), 30.0, Rendered);
  EXPECT_TRUE(std::isnan(found.given_db) && std::isnan(found.resected_db));
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
