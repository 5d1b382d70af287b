#include "surface/views/see_through.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "surface/surface_options.h"

namespace skyquilt::surface {

bool SeesThrough(std::span<const DepthView> views, const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal_enu, double tolerance_m) {
  const double least_cosine = std::cos(kMaxAngle_deg * std::numbers::pi / 180.0);
  constexpr double kFarthestPx = 0.75;  // of a place from the centre of its pixel
  for (const DepthView& view : views) {
    if (view.pose.photo < 0) continue;
    const std::optional<Eigen::Vector2d> at = view.pose.Project(x_in_enu);
    if (!at) continue;
    const Eigen::Vector3d ray = x_in_enu - view.pose.Centre();
    const double distance_m = ray.norm(), cosine = std::abs(ray.dot(normal_enu)) / distance_m;
    if (!(cosine >= least_cosine)) continue;
    const size_t pixel = static_cast<size_t>(at->y()) * static_cast<size_t>(view.pose.width) + static_cast<size_t>(at->x());
    if (std::isnan(view.depth_m[pixel]) && view.cosine[pixel] == kMeetsNothing) return true;
    // Of the place's own surface, the pixel's centre may show a part that is farther by this, measured along the normal.
    const double slack_m = kFarthestPx * distance_m / view.pose.focal_px * std::sqrt(1.0 - std::min(1.0, cosine * cosine));
    // False for NaN: no depth is known.
    if ((static_cast<double>(view.depth_m[pixel]) - distance_m) * cosine > tolerance_m + slack_m) return true;
  }
  return false;
}

}  // namespace skyquilt::surface
