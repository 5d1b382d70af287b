// Size of a camera's pixels as angles, after removal of the lens distortion: the width of a pixel's cone at distance 1 along its ray.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/camera/camera.h"

namespace skyquilt::camera {

class PixelPitch {
 public:
  // Computes the pitch on a coarse lattice over the image.
  explicit PixelPitch(const Camera& camera);

  // Square root of the solid angle that the pixel around an image position covers, radians; interpolated between lattice points. Positions outside
  // the image count as on its edge.
  double At(const Eigen::Vector2d& pixel) const;

 private:
  double width_, height_;
  std::vector<double> lattice_;  // row-major
};

}  // namespace skyquilt::camera
