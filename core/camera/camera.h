// Camera models of COLMAP: maps between pixels and rays with intrinsics and lens distortion, so that photos need not be undistorted first.
// Pixels: the image corner is (0, 0), the centre of the first pixel (0.5, 0.5). Camera frame: x right, y down, z forward.
// Parameter order per model is COLMAP's (src/colmap/sensor/models.h):
//   SIMPLE_PINHOLE f cx cy | PINHOLE fx fy cx cy | SIMPLE_RADIAL f cx cy k | RADIAL f cx cy k1 k2
//   OPENCV fx fy cx cy k1 k2 p1 p2 | OPENCV_FISHEYE fx fy cx cy k1..k4 | FULL_OPENCV fx fy cx cy k1 k2 p1 p2 k3..k6
//   FOV fx fy cx cy omega | SIMPLE_RADIAL_FISHEYE f cx cy k | RADIAL_FISHEYE f cx cy k1 k2
//   THIN_PRISM_FISHEYE fx fy cx cy k1 k2 p1 p2 k3 k4 sx1 sy1 | RAD_TAN_THIN_PRISM_FISHEYE fx fy cx cy k0..k5 p0 p1 s0..s3
// COLMAP's FOV takes the inverse's series for |omega| < 0.01, which differs from the model by up to omega^2 / 6 of the radius; here the model holds.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::camera {

// The numbers are COLMAP's ids.
enum class CameraModel {
  kSimplePinhole = 0,
  kPinhole = 1,
  kSimpleRadial = 2,
  kRadial = 3,
  kOpencv = 4,
  kOpencvFisheye = 5,
  kFullOpencv = 6,
  kFov = 7,
  kSimpleRadialFisheye = 8,
  kRadialFisheye = 9,
  kThinPrismFisheye = 10,
  kRadTanThinPrismFisheye = 11
};

// COLMAP's name, number of parameters and id of a model. FromName / FromId return nothing for models we do not support.
std::string ModelName(CameraModel model);
int ModelParamCount(CameraModel model);
std::optional<CameraModel> ModelFromName(const std::string& name);
std::optional<CameraModel> ModelFromId(int colmap_id);
// Names of all models, for messages: "SIMPLE_PINHOLE, PINHOLE, ... or ...".
std::string ModelNames();
// Whether the parameters begin with f, cx, cy; the others' with fx, fy, cx, cy.
bool HasOneFocalLength(CameraModel model);
// Whether distortion depends on the angle from the axis, and not on its tangent.
bool IsFisheye(CameraModel model);

struct Camera {
  CameraModel model = CameraModel::kPinhole;
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::vector<double> params;

  // Empty when the camera can be used, otherwise the problem in words (size, number of parameters, focal length, omega, not finite).
  std::string Problem() const;
  double FocalX() const;
  double FocalY() const;
  Eigen::Vector2d PrincipalPoint() const;
  // Distance from the principal point to the farthest image corner, pixels.
  double MaxImageRadius() const;

  // Projects a point in the camera frame to its pixel, which may be outside the image. Nothing when z <= 0 (fisheye models too), and beyond the
  // radius where the distortion stops growing: there its polynomial would map far-off points back into the image.
  std::optional<Eigen::Vector2d> ImgFromCam(const Eigen::Vector3d& x_in_cam) const;
  // Unit direction of a pixel's ray in the camera frame. Distortion is inverted with Newton steps and a slower fallback;
  // outside the invertible region the nearest direction found is returned, never NaN.
  Eigen::Vector3d RayFromImg(const Eigen::Vector2d& pixel) const;

  // The camera of the resized image: focal lengths and principal point are scaled, distortion stays.
  // If the aspect ratio changes, a model with one focal length becomes the same lens with two (PINHOLE, OPENCV, OPENCV_FISHEYE).
  Camera Resized(int new_width, int new_height) const;
};

class Distortion;  // distortion.h

// The distortion of the camera's lens, for those who need more than its rays and pixels.
Distortion DistortionOf(const Camera& camera);

// GSD: metres per pixel on flat ground straight below a camera that is `agl_m` above it.
double GroundSamplingDistance(const Camera& camera, double agl_m);

}  // namespace skyquilt::camera
