// Where the surface ends: what stands there may go on beyond.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "buildings/candidates/cell_mask.h"
#include "buildings/geometry/polygon.h"
#include "buildings/points/surface_points.h"
#include "core/geo/plane_grid.h"

namespace skyquilt::buildings {

// Places without surface that are connected with the outside of the survey seen from above. Gaps inside the survey, such as those behind buildings,
// are no edge. Of no use for an empty cloud: then everything is outside.
class SurveyEdge {
 public:
  explicit SurveyEdge(const PointCloud& cloud);

  // Metres to the middle of the nearest cell outside the survey, less half a cell; 0 outside.
  double DistanceTo(const Eigen::Vector2d& enu) const;
  // Share of an outline's length that is within reach_m of the outside.
  double ShareOf(const Polygon& outline, double reach_m) const;

 private:
  geo::PlaneGrid grid_;
  CellMask outside_;
  std::vector<int32_t> nearest_;
};

}  // namespace skyquilt::buildings
