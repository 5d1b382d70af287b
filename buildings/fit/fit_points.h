// The points of a candidate in the frame of a shape's origin, as the fit uses them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/building.h"
#include "buildings/candidates/find_candidates.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

struct FitPoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // ENU minus the shape's origin
  double z = 0.0;                                   // ENU
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double views = 0.0;
};

struct FitPoints {
  std::vector<FitPoint> roof;   // that look up
  std::vector<FitPoint> steep;  // of walls, and of the rims of roofs
  std::vector<FitPoint> ground;
  double spacing_m = 0.0;
  double roof_views = 0.0;  // median of the roof's
};
FitPoints PointsFor(const Shape& shape, const Candidate& candidate, const PointCloud& cloud);

// From ENU minus origin to u, v.
inline Eigen::Vector2d InAxes(const Shape& shape, const Eigen::Vector2d& place) {
  return {shape.AxisU().dot(place), shape.AxisV().dot(place)};
}

}  // namespace skyquilt::buildings
