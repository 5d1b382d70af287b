// What a photo shows of level ground, roughly, and how photos spread over it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/camera/camera.h"

namespace skyquilt::prepare::poses {

// A circle about where the photo's middle looks, or about the camera when that is near the horizon.
struct Footprint {
  Eigen::Vector2d centre;  // ENU metres
  double radius_m = 0.0;   // half the mean of its sides
  Eigen::Vector3d axis;    // in which the camera looks, ENU, a unit vector

  double DistanceTo(const Footprint& other) const { return (centre - other.centre).norm() / (radius_m + other.radius_m); }
  // It shows enough of the same ground from like enough directions that features of both could be matched.
  bool IsLike(const Footprint& other) const;
  // Neither shows anything of what the other does, even if poses are rather wrong.
  bool IsFarFrom(const Footprint& other) const;
};

// `height_m`: of the camera above ground.
Footprint FootprintOf(const camera::Camera& camera, const Eigen::Quaterniond& cam_from_enu, const Eigen::Vector3d& centre, double height_m);

// Standard deviations of places in the plane, in the two directions in which they are least and most. Not of none.
struct Spread {
  double smaller = 0.0, larger = 0.0;
};
Spread SpreadOf(const std::vector<Eigen::Vector2d>& places);

}  // namespace skyquilt::prepare::poses
