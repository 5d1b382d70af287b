// Pixel pitches of wide and of strongly distorted cameras, pixel by pixel, against the solid angles of the pixels.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/camera/pixel_pitch.h"

namespace skyquilt::camera {
namespace {

// Solid angle of a triangle of unit directions (van Oosterom and Strackee 1983).
double SolidAngle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return 2.0 * std::atan2(std::abs(a.dot(b.cross(c))), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
}

double SolidAngleOfPixel(const Camera& camera, double x, double y) {
  const Eigen::Vector3d a = camera.RayFromImg({x, y}), b = camera.RayFromImg({x + 1.0, y}), c = camera.RayFromImg({x + 1.0, y + 1.0}),
                        d = camera.RayFromImg({x, y + 1.0});
  return SolidAngle(a, b, c) + SolidAngle(a, c, d);
}

struct Lens {
  std::string name;
  Camera camera;
};

class PitchOfLens : public ::testing::TestWithParam<Lens> {};

TEST_P(PitchOfLens, IsTheRootOfEveryPixelsSolidAngle) {
  const Camera& camera = GetParam().camera;
  ASSERT_EQ(camera.Problem(), "");
  const PixelPitch pitch(camera);
  double worst = 0.0, sum = 0.0, exact_sum = 0.0;
  for (int y = 0; y < camera.height; y += 3) {
    for (int x = 0; x < camera.width; x += 3) {
      const double exact = SolidAngleOfPixel(camera, x, y), seen = pitch.At({x + 0.5, y + 0.5});
      worst = std::max(worst, std::abs(seen / std::sqrt(exact) - 1.0));
      sum += seen * seen;
      exact_sum += exact;
    }
  }
  // Interpolation in the coarse lattice.
  EXPECT_LT(worst, 0.02);
  EXPECT_NEAR(sum / exact_sum, 1.0, 0.01);
}

// The pixels of wide images differ, so that one pitch for the whole image would fail.
TEST_P(PitchOfLens, DiffersBetweenCentreAndCorner) {
  const Camera& camera = GetParam().camera;
  const PixelPitch pitch(camera);
  const double ratio = pitch.At({0.5, 0.5}) / pitch.At(camera.PrincipalPoint());
  EXPECT_TRUE(ratio < 0.9 || ratio > 1.1) << ratio;
}

INSTANTIATE_TEST_SUITE_P(
    Lenses, PitchOfLens,
    ::testing::Values(Lens{"pinhole_of_118_degrees", {CameraModel::kPinhole, 400, 300, {120.0, 120.0, 200.0, 150.0}}},
                      Lens{"barrel_distortion", {CameraModel::kOpencv, 400, 300, {250.0, 255.0, 205.0, 148.0, -0.28, 0.09, 0.001, -0.0005}}},
                      Lens{"pincushion_distortion", {CameraModel::kSimpleRadial, 400, 300, {300.0, 200.0, 150.0, 0.2}}},
                      Lens{"fisheye_of_150_degrees", {CameraModel::kOpencvFisheye, 400, 300, {150.0, 150.0, 200.0, 150.0, 0.03, -0.01, 0.0, 0.0}}}),
    [](const auto& of) { return of.param.name; });

TEST(PixelPitch, OutsideTheImageIsThatOfItsEdge) {
  const PixelPitch pitch({CameraModel::kPinhole, 400, 300, {120.0, 120.0, 200.0, 150.0}});
  EXPECT_EQ(pitch.At({-50.0, 100.0}), pitch.At({0.0, 100.0}));
  EXPECT_EQ(pitch.At({1e9, -1e9}), pitch.At({400.0, 0.0}));
}

}  // namespace
}  // namespace skyquilt::camera
