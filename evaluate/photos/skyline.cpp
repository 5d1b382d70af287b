#include "evaluate/photos/skyline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace skyquilt::evaluate::photos {

Skyline::Skyline(std::span<const survey::SparsePoint> points, const Eigen::Vector3d& eye_enu) {
  std::array<double, kSides> own;
  own.fill(-1.0);
  for (const survey::SparsePoint& point : points) {
    const Eigen::Vector3d to_point = point.x_in_enu - eye_enu;
    const double distance_m = to_point.norm();
    if (!(distance_m > 0.0)) continue;
    double& highest = own[SideOf(to_point)];
    highest = std::max(highest, to_point.z() / distance_m);
  }
  for (size_t side = 0; side < kSides; ++side) {
    highest_[side] = std::max({own[(side + kSides - 1) % kSides], own[side], own[(side + 1) % kSides]});
  }
}

size_t Skyline::SideOf(const Eigen::Vector3d& direction_enu) {
  constexpr double kSidesPerRad = kSides / (2.0 * std::numbers::pi);
  const double angle = std::atan2(direction_enu.y(), direction_enu.x()) + std::numbers::pi;
  return std::min(static_cast<size_t>(angle * kSidesPerRad), kSides - 1);
}

bool Skyline::IsAbove(const Eigen::Vector3d& direction_enu) const {
  return direction_enu.z() > 0.0 && direction_enu.z() / direction_enu.norm() > highest_[SideOf(direction_enu)];
}

}  // namespace skyquilt::evaluate::photos
