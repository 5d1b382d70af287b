// Cameras around made buildings.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "core/camera/camera.h"
#include "core/geo/transform.h"

namespace skyquilt::buildings {

// Looks from one place at another, with the image upright. Not straight down.
inline geo::Rigid3d LookingAt(const Eigen::Vector3d& from, const Eigen::Vector3d& at) {
  const Eigen::Vector3d forward = (at - from).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = right.transpose();
  rotation.row(1) = forward.cross(right).transpose();
  rotation.row(2) = forward.transpose();
  geo::Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(rotation);
  pose.translation = -(pose.rotation * from);
  return pose;
}

// Straight down, north up.
inline geo::Rigid3d LookingDownFrom(const Eigen::Vector3d& from) {
  geo::Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
  pose.translation = -(pose.rotation * from);
  return pose;
}

inline camera::Camera Pinhole(int width = 600, int height = 450, double focal = 500.0) {
  return {camera::CameraModel::kPinhole, width, height, {focal, focal, 0.5 * width, 0.5 * height}};
}

// The same with a barrel distortion.
inline camera::Camera Barrel() {
  return {camera::CameraModel::kOpencv, 600, 450, {500.0, 500.0, 300.0, 225.0, -0.25, 0.03, 0.001, -0.001}};
}

}  // namespace skyquilt::buildings
