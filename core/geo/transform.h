// Rigid and similarity transforms. A name b_from_a maps x_in_a to x_in_b.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skyquilt::geo {

struct Rigid3d {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }
  Rigid3d Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }
  // For cam_from_world: the camera centre in world coordinates.
  Eigen::Vector3d OriginInSource() const { return -(rotation.conjugate() * translation); }
};

struct Similarity3d {
  double scale = 1.0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return scale * (rotation * x) + translation; }
};

// cam_from_b from cam_from_a and b_from_a. The camera frame is scaled too: it is in metres when b is.
Rigid3d TransformCameraWorld(const Rigid3d& cam_from_a, const Similarity3d& b_from_a);

}  // namespace skyquilt::geo
