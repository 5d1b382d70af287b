// What a camera's pixels need to become rays, looked up once: for loops over many pixels of one camera.
#pragma once

#include <Eigen/Core>

#include "core/camera/camera.h"
#include "core/camera/distortion.h"

namespace skyquilt::camera {

class Lens {
 public:
  explicit Lens(const Camera& camera)
      : distortion_(DistortionOf(camera)), focal_(camera.FocalX(), camera.FocalY()), principal_point_(camera.PrincipalPoint()) {}

  // As Camera::RayFromImg, with the same bits.
  Eigen::Vector3d RayFromImg(const Eigen::Vector2d& pixel) const { return distortion_.Undistort((pixel - principal_point_).cwiseQuotient(focal_)); }

 private:
  Distortion distortion_;
  Eigen::Vector2d focal_;
  Eigen::Vector2d principal_point_;
};

}  // namespace skyquilt::camera
