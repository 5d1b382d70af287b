#include "core/camera/equirectangular.h"

#include <cmath>
#include <numbers>

namespace skyquilt::camera {

Eigen::Vector3d Equirectangular::RayFromImg(const Eigen::Vector2d& pixel) const {
  const double azimuth = 2.0 * std::numbers::pi * (pixel.x() / width - 0.5);
  const double elevation = std::numbers::pi * (0.5 - pixel.y() / height);
  return {std::cos(elevation) * std::sin(azimuth), -std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

Eigen::Vector2d Equirectangular::ImgFromRay(const Eigen::Vector3d& direction) const {
  const double azimuth = std::atan2(direction.x(), direction.z());
  const double elevation = std::atan2(-direction.y(), std::hypot(direction.x(), direction.z()));
  const double column = width * (0.5 + azimuth / (2.0 * std::numbers::pi));
  return {column < width ? column : 0.0, height * (0.5 - elevation / std::numbers::pi)};
}

}  // namespace skyquilt::camera
