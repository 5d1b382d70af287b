#include "prepare/poses/seed/footprint.h"

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

}  // namespace skyquilt::prepare::poses
