// The points of a candidate in the axes of its building.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/building.h"
#include "buildings/candidates/find_candidates.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

struct AxisPoint {
  Eigen::Vector3d at;      // u, v, and height in ENU
  Eigen::Vector3d normal;  // along u, v, up
};

struct AxisPoints {
  std::vector<AxisPoint> roof;   // that look up
  std::vector<AxisPoint> steep;  // walls around the candidate, and those of what stands on its roofs
  Polygon outline;               // u, v
  double spacing_m = 0.0;        // about one point per spacing_m^2 of surface
};

// Smallest vertical part of the normal of roofs, and the largest of walls.
inline constexpr double kRoofNormal = 0.3;
inline constexpr double kWallNormal = 0.35;

// axes: origin and yaw are used. Points without a finite place are left out.
AxisPoints InAxes(const Candidate& candidate, const PointCloud& cloud, const Shape& axes);

}  // namespace skyquilt::buildings
