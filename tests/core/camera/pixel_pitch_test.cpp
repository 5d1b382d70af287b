#include "core/camera/pixel_pitch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace skyquilt::camera {
namespace {

TEST(PixelPitch, OfAPinholeIsTheRootOfThePixelsSolidAngle) {
  const Camera camera{CameraModel::kPinhole, 800, 600, {700.0, 650.0, 400.0, 300.0}};
  const PixelPitch pitch(camera);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(400, 300), Eigen::Vector2d(10, 20), Eigen::Vector2d(700, 100), Eigen::Vector2d(333, 599)}) {
    const double cosine = camera.RayFromImg(pixel).z();
    const double exact = std::sqrt(cosine * cosine * cosine / (700.0 * 650.0));
    EXPECT_NEAR(pitch.At(pixel) / exact, 1.0, 3e-3) << pixel.transpose();
  }
}

TEST(PixelPitch, SumsToTheSolidAngleOfADistortedImage) {
  // The same frame with and without distortion must be divided into pixels without rest: the pitch follows the undistorted pixels.
  const Camera camera{CameraModel::kOpencv, 400, 300, {350.0, 350.0, 200.0, 150.0, -0.1, 0.02, 0.001, -0.001}};
  const PixelPitch pitch(camera);
  double sum = 0.0, exact = 0.0;
  for (int y = 0; y < 300; y += 2) {
    for (int x = 0; x < 400; x += 2) {
      const double p = pitch.At({x + 1.0, y + 1.0});
      sum += 4.0 * p * p;
      const Eigen::Vector3d a = camera.RayFromImg({x, y}), b = camera.RayFromImg({x + 2.0, y}), c = camera.RayFromImg({x + 2.0, y + 2.0}),
                            d = camera.RayFromImg({x, y + 2.0});
      exact += 0.5 * ((b - a).cross(c - a).norm() + (c - a).cross(d - a).norm());
    }
  }
  EXPECT_NEAR(sum / exact, 1.0, 2e-3);
}

TEST(PixelPitch, GrowsAsTheImageShrinks) {
  const Camera camera{CameraModel::kPinhole, 800, 600, {700.0, 700.0, 400.0, 300.0}};
  EXPECT_NEAR(PixelPitch(camera.Resized(100, 75)).At({50, 37.5}) / PixelPitch(camera).At({400, 300}), 8.0, 0.05);
}

}  // namespace
}  // namespace skyquilt::camera
