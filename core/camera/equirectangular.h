// Panoramas of all directions, equirectangular: a column is an azimuth, a row an elevation. Camera frame of the panorama: x right, y down, z to its
// middle. Pixels as in camera.h: the picture's corner is (0, 0), the centre of the first pixel (0.5, 0.5).
#pragma once

#include <Eigen/Core>

namespace skyquilt::camera {

// Size of the whole sphere in pixels; a picture may be a part of it.
struct Equirectangular {
  int width = 0;   // 360 degrees, usually twice the height
  int height = 0;  // 180 degrees

  // Unit direction. Columns beyond the edges go on around the sphere; rows are within [0, height].
  Eigen::Vector3d RayFromImg(const Eigen::Vector2d& pixel) const;
  // Column in [0, width), row in [0, height]. The length of the direction does not matter, but it is not zero. Straight up and down, where every
  // column is right, it is the middle one.
  Eigen::Vector2d ImgFromRay(const Eigen::Vector3d& direction) const;
};

}  // namespace skyquilt::camera
