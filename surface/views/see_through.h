// Openings of a surface, told by pictures of depth.
#pragma once

#include <span>

#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// Whether a photo's picture shows something more than tolerance_m behind this place of a surface, whose normal has length 1, or a ray
// that meets nothing. Where nothing is known does not count, nor what is seen at angles flatter than kMaxAngle_deg. From either side: what is open is
// so for both.
bool SeesThrough(std::span<const DepthView> views, const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal_enu, double tolerance_m);

}  // namespace skyquilt::surface
