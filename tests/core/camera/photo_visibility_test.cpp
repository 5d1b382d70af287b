#include "core/camera/photo_visibility.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace skyquilt::camera {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Looks straight down from 100 m above the origin: the frame covers 100 m from west to east and 80 m from south to north at z = 0.
const Camera kLens{CameraModel::kPinhole, 100, 80, {100.0, 100.0, 50.0, 40.0}};
geo::Rigid3d Down() {
  geo::Rigid3d cam_from_enu;
  cam_from_enu.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  cam_from_enu.translation = {0.0, 0.0, 100.0};
  return cam_from_enu;
}
bool Seen(const Eigen::Vector3d& x, const VisibilityRule& rule = {}) {
  return IsVisible(kLens, Down(), x, rule);
}

TEST(Shows, PlacesInTheFrame) {
  EXPECT_TRUE(Seen({0, 0, 0}));
  EXPECT_TRUE(Seen({-49.9, 39.9, 0}));
  EXPECT_FALSE(Seen({-50.1, 0, 0}));
  EXPECT_FALSE(Seen({0, 40.1, 0}));
  EXPECT_FALSE(Seen({0, 0, 100})) << "at the camera";
  EXPECT_FALSE(Seen({0, 0, 110})) << "behind the camera";
  EXPECT_FALSE(Seen({std::nan(""), 0, 0}));
  EXPECT_FALSE(Seen({0, 0, -kInfinity}));
}

TEST(Shows, FarEdgesOnlyWhenAskedFor) {
  EXPECT_TRUE(Seen({-50, 40, 0})) << "left and upper edge";
  EXPECT_FALSE(Seen({50, 0, 0}));
  EXPECT_FALSE(Seen({0, -40, 0}));
  EXPECT_TRUE(Seen({50, -40, 0}, {.far_edges = true}));
}

TEST(Shows, BallsThatReachIntoTheFrame) {
  EXPECT_TRUE(Seen({52, 0, 0}, {.radius_m = 2.5}));
  EXPECT_FALSE(Seen({53, 0, 0}, {.radius_m = 2.5}));
  EXPECT_TRUE(Seen({0, 0, 101}, {.radius_m = 2.0})) << "around the camera";
  EXPECT_TRUE(Seen({6, 0, 100}, {.radius_m = 2.0})) << "next to the camera";
  EXPECT_FALSE(Seen({9, 0, 100}, {.radius_m = 2.0}));
  EXPECT_FALSE(Seen({0, 0, 103}, {.radius_m = 2.0}));
}

TEST(Shows, NotBeyondReach) {
  EXPECT_TRUE(Seen({30, 40, 0}, {.reach_m = 111.9, .far_edges = true}));
  EXPECT_FALSE(Seen({30, 40, 0}, {.reach_m = 111.7, .far_edges = true}));
}

TEST(Shows, NotOnIgnoredPixels) {
  std::vector<uint8_t> mask(8000, 1);
  mask[20 * 100 + 30] = 0;
  EXPECT_FALSE(Seen({-19.5, 19.5, 0}, {.mask = mask}));
  EXPECT_TRUE(Seen({-18.5, 19.5, 0}, {.mask = mask}));
  mask[99] = 0;
  EXPECT_FALSE(Seen({51, 41, 0}, {.radius_m = 2.0, .mask = mask})) << "outside the frame the mask of the nearest pixel is used";
}

// The three rules of the callers, written out separately: Shows must agree with each of them.
bool GroundRule(const Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& x, double reach) {
  if ((x - cam_from_enu.OriginInSource()).squaredNorm() > reach * reach) return false;
  const auto pixel = camera.ImgFromCam(cam_from_enu * x);
  return pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= camera.width && pixel->y() <= camera.height;
}
bool BallRule(const Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& x, double radius_m) {
  const Eigen::Vector3d in_cam = cam_from_enu * x;
  if (in_cam.z() < -radius_m || (radius_m <= 0.0 && in_cam.z() <= 0.0)) return false;
  if (in_cam.z() <= radius_m) return in_cam.norm() < 4.0 * radius_m;
  const auto pixel = camera.ImgFromCam(in_cam);
  if (!pixel) return false;
  const double slack = camera.FocalX() * radius_m / in_cam.z();
  return pixel->x() >= -slack && pixel->x() < camera.width + slack && pixel->y() >= -slack && pixel->y() < camera.height + slack;
}
bool PixelRule(const Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& x, std::span<const uint8_t> mask) {
  const auto pixel = camera.ImgFromCam(cam_from_enu * x);
  if (!pixel || !(pixel->x() >= 0.0) || !(pixel->y() >= 0.0) || !(pixel->x() < camera.width) || !(pixel->y() < camera.height)) return false;
  if (mask.empty()) return true;
  return mask[static_cast<size_t>(pixel->y()) * static_cast<size_t>(camera.width) + static_cast<size_t>(pixel->x())] != 0;
}

double Between(int low, int high) {
  return *rc::gen::inRange(16 * low, 16 * high + 1) / 16.0;
}

RC_GTEST_PROP(Shows, AgreesWithTheRulesOfItsCallers, ()) {
  const Camera curved{CameraModel::kOpencv, 100, 80, {90.0, 95.0, 48.0, 41.0, -0.2, 0.05, 1e-3, -2e-3}};
  std::vector<uint8_t> mask(8000);
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = i % 3 == 0 || i / 1000 == 5 ? 0 : 1;
  for (int i = 0; i < 100; ++i) {
    // Half of the poses look straight down and places are on a lattice, so that many are exactly on edges of the frame and of pixels.
    const bool plain = *rc::gen::arbitrary<bool>();
    const Camera& camera = plain ? kLens : curved;
    geo::Rigid3d pose = Down();
    if (!plain) {
      pose.rotation = Eigen::Quaterniond(Between(-1, 1), 1.0, Between(-1, 1), Between(-1, 1)).normalized();
      pose.translation = {Between(-9, 9), Between(-9, 9), Between(50, 100)};
    }
    const Eigen::Vector3d x(Between(-70, 70), Between(-60, 60), *rc::gen::arbitrary<bool>() ? 0.0 : Between(-20, 130));
    const double reach = *rc::gen::arbitrary<bool>() ? Between(1, 200) : kInfinity;
    const double radius = *rc::gen::arbitrary<bool>() ? Between(0, 20) : 0.0;
    RC_ASSERT(IsVisible(camera, pose, x, {.reach_m = reach, .far_edges = true}) == GroundRule(camera, pose, x, reach));
    RC_ASSERT(IsVisible(camera, pose, x, {.radius_m = radius}) == BallRule(camera, pose, x, radius));
    RC_ASSERT(IsVisible(camera, pose, x, {.mask = mask}) == PixelRule(camera, pose, x, mask));
    RC_ASSERT(IsVisible(camera, pose, x) == PixelRule(camera, pose, x, {}));
  }
}

}  // namespace
}  // namespace skyquilt::camera
