// Where the camera looks along a way. Heading, pitch and roll are interpolated each for itself: between two level cameras the shortest rotation would
// tilt the horizon. When both ends look at the same thing, the camera keeps looking at it; on an orbit it looks at the middle of the orbit. As
// web/src/tour/orientation.ts.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "tour/format/tour.h"

namespace skyquilt::tour {

// An eye on the way; `share` of its length lies behind.
struct WayPlace {
  Eigen::Vector3d eye_enu;
  double share = 0.0;
};

// cam_from_enu at all places; those of the ends are the given ones. about: middle of an orbit.
std::vector<Eigen::Quaterniond> RotationsAlong(const std::vector<WayPlace>& places, const Pose& from, const Pose& to,
                                               const std::optional<Eigen::Vector3d>& about);

}  // namespace skyquilt::tour
