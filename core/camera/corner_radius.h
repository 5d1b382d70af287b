// Distances from the principal point relative to that of the farthest corner: 0 on the optical axis, at most 1 in the image. Vignetting is a function
// of them.
#pragma once

#include <Eigen/Core>

#include "core/camera/camera.h"

namespace skyquilt::camera {

class CornerRadius {
 public:
  explicit CornerRadius(const Camera& camera)
      : middle_(camera.PrincipalPoint()), per_radius2_(1.0 / (camera.MaxImageRadius() * camera.MaxImageRadius())) {}

  // The square of that of a pixel position.
  float Squared(const Eigen::Vector2d& pixel) const { return static_cast<float>((pixel - middle_).squaredNorm() * per_radius2_); }

 private:
  Eigen::Vector2d middle_;
  double per_radius2_;
};

}  // namespace skyquilt::camera
