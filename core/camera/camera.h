// Intrinsics and lens distortion of COLMAP's camera models, without resampling any image.
// Pixels: the image corner is (0, 0), the centre of the first pixel (0.5, 0.5). Camera frame: x right, y down, z forward.
// Parameter order per model is COLMAP's (src/colmap/sensor/models.h):
//   SIMPLE_PINHOLE f cx cy | PINHOLE fx fy cx cy | SIMPLE_RADIAL f cx cy k | RADIAL f cx cy k1 k2
//   OPENCV fx fy cx cy k1 k2 p1 p2 | OPENCV_FISHEYE fx fy cx cy k1..k4 | FULL_OPENCV fx fy cx cy k1 k2 p1 p2 k3..k6
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::camera {

enum class CameraModel { kSimplePinhole = 0, kPinhole = 1, kSimpleRadial = 2, kRadial = 3, kOpencv = 4, kOpencvFisheye = 5, kFullOpencv = 6 };

// COLMAP's name and number of parameters. FromName / FromId return nothing for models we do not support.
std::string ModelName(CameraModel model);
int ModelParamCount(CameraModel model);
std::optional<CameraModel> ModelFromName(const std::string& name);
std::optional<CameraModel> ModelFromId(int colmap_id);

struct Camera {
  CameraModel model = CameraModel::kPinhole;
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::vector<double> params;

  // Empty when usable, otherwise what is wrong (size, parameter count, focal length, not finite).
  std::string Problem() const;
  double FocalX() const;
  double FocalY() const;
  Eigen::Vector2d PrincipalPoint() const;
  // Pixels from the principal point to the farthest corner of the image.
  double FarthestCorner() const;

  // Pixel of a point in the camera frame; nothing when it is not in front of the camera (fisheye: also none at the centre), nor when it
  // lies beyond the first fold of the distortion, where its polynomial would mirror far-off points back into the image.
  std::optional<Eigen::Vector2d> ImgFromCam(const Eigen::Vector3d& x_in_cam) const;
  // Unit direction of a pixel's ray in the camera frame. Distortion is inverted by Newton steps with a fixed-point fallback;
  // outside the invertible region the nearest converged direction is returned, never NaN.
  Eigen::Vector3d RayFromImg(const Eigen::Vector2d& pixel) const;

  // The same lens on an image of another size (focal lengths and principal point scale, distortion stays).
  // A change of aspect turns a model with one focal length into the same lens with two (PINHOLE, OPENCV).
  Camera Resized(int new_width, int new_height) const;
};

// Metres per pixel on flat ground straight below, for a camera `agl_m` above it.
double GroundSamplingDistance(const Camera& camera, double agl_m);

}  // namespace skyquilt::camera
