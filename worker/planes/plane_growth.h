// Plane regions of scattered points, by growing. Any frame whose z is up, metres.
//
// The normal of a point is that of the plane through its k = 16 nearest points. A region starts at the point with the flattest neighbourhood and
// takes in neighbours of its points that lie within kPlaneBand_gsd of its plane and whose normals agree with it; the plane is fitted anew as it
// grows. Points whose neighbourhoods are thick, as in trees, belong to none. No chance and no threads: the same points give the same regions.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "worker/planes/plane_fit.h"

namespace skyquilt::worker {

struct PlaneRegion {
  Plane plane;  // normal upward or horizontal
  double rms_m = 0.0;
  double spacing_m = 0.0;  // median over its points of the spacing in their neighbourhoods
  std::vector<int32_t> points;
  std::vector<int32_t> elsewhere;  // points beside or between them that show that the surface leaves the plane there
};

constexpr int kFewestRegionPoints = 20;
constexpr double kPlaneBand_gsd = 1.5;
constexpr double kLargestPlaneRms_gsd = 1.5;
// A region ends this far from its start, 15 m at 3 cm per pixel: ground that curves becomes several planes, each of which is the mean of what is
// near, and errors of the poses that bend a whole survey do not matter. Measured in pixels because surveys without tags have no metres. A smaller
// region would have too few points: a square of 30 m has some hundreds.
constexpr double kPlaneRadius_gsd = 500.0;

// Coordinates must be finite; gsd_m > 0. No point belongs to two regions.
std::vector<PlaneRegion> GrowPlanes(const std::vector<Eigen::Vector3d>& points, double gsd_m);

}  // namespace skyquilt::worker
