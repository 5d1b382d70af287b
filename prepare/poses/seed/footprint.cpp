#include "prepare/poses/seed/footprint.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::prepare::poses {

bool Footprint::IsLike(const Footprint& other) const {
  constexpr double kNear = 0.75, kLeastCosine = 0.77;  // 40 degrees
  return DistanceTo(other) < kNear && axis.dot(other.axis) > kLeastCosine;
}

bool Footprint::IsFarFrom(const Footprint& other) const {
  // A circle about a square has 1.4 times half of its side.
  constexpr double kFar = 2.0;
  return DistanceTo(other) > kFar;
}

Footprint FootprintOf(const camera::Camera& camera, const Eigen::Quaterniond& cam_from_enu, const Eigen::Vector3d& centre, double height_m) {
  const Eigen::Vector3d axis = cam_from_enu.conjugate() * Eigen::Vector3d::UnitZ();
  constexpr double kLeastDown = 0.3;
  const Eigen::Vector2d ahead = axis.z() < -kLeastDown ? Eigen::Vector2d(axis.head<2>() * (height_m / -axis.z())) : Eigen::Vector2d::Zero();
  return {centre.head<2>() + ahead, height_m * (camera.width + camera.height) / (4.0 * camera.FocalX()), axis};
}

Spread SpreadOf(const std::vector<Eigen::Vector2d>& places) {
  const auto n = static_cast<double>(places.size());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& place : places) mean += place;
  mean /= n;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& place : places) covariance += (place - mean) * (place - mean).transpose() / n;
  const double half_trace = 0.5 * covariance.trace();
  const double root = std::sqrt(std::max(half_trace * half_trace - covariance.determinant(), 0.0));
  return {std::sqrt(std::max(half_trace - root, 0.0)), std::sqrt(half_trace + root)};
}

}  // namespace skyquilt::prepare::poses
