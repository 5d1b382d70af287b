#include "core/camera/photo_visibility.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::camera {
namespace {

bool InFrame(const Camera& camera, const Eigen::Vector2d& pixel, double slack, bool far_edges) {
  if (!(pixel.x() >= -slack) || !(pixel.y() >= -slack)) return false;
  const double right = camera.width + slack, bottom = camera.height + slack;
  return far_edges ? pixel.x() <= right && pixel.y() <= bottom : pixel.x() < right && pixel.y() < bottom;
}

bool Unmasked(const Camera& camera, const Eigen::Vector2d& pixel, std::span<const uint8_t> mask) {
  if (mask.empty()) return true;
  const auto column = static_cast<size_t>(std::clamp(pixel.x(), 0.0, camera.width - 1.0));
  const auto row = static_cast<size_t>(std::clamp(pixel.y(), 0.0, camera.height - 1.0));
  return mask[row * static_cast<size_t>(camera.width) + column] != 0;
}

}  // namespace

bool IsVisible(const Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& x_in_enu, const VisibilityRule& rule) {
  if (std::isfinite(rule.reach_m) && (x_in_enu - cam_from_enu.OriginInSource()).squaredNorm() > rule.reach_m * rule.reach_m) return false;
  const Eigen::Vector3d in_cam = cam_from_enu * x_in_enu;
  const double radius_m = rule.radius_m;
  if (radius_m > 0.0) {
    if (in_cam.z() < -radius_m) return false;
    // The ball intersects the camera plane, so that its centre may have no pixel.
    if (in_cam.z() <= radius_m) return in_cam.norm() < 4.0 * radius_m;
  }
  const auto pixel = camera.ImgFromCam(in_cam);
  if (!pixel) return false;
  const double slack = radius_m > 0.0 ? camera.FocalX() * radius_m / in_cam.z() : 0.0;
  return InFrame(camera, *pixel, slack, rule.far_edges) && Unmasked(camera, *pixel, rule.mask);
}

}  // namespace skyquilt::camera
