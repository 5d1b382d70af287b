// The surface seen from above on a small raster: how high it is, and how green.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <vector>

#include "buildings/candidates/cell_mask.h"
#include "buildings/candidates/plan_index.h"
#include "buildings/points/surface_points.h"
#include "core/geo/plane_grid.h"

namespace skyquilt::buildings {

// Excess green (2g - r - b) / (r + g + b): grey 0, lawns 0.1 to 0.3; 0 for black.
double ExcessGreen(const SurfacePoint& point);

struct TopRaster : geo::PlaneGrid {
  std::vector<float> top_z;  // ENU z of the highest point; between points, up to about one spacing, the median of those around; NaN: none
  std::vector<float> green;  // mean over the points near the top, likewise

  // NaN outside.
  double TopAt(int column, int row) const {
    return Inside(column, row) ? static_cast<double>(top_z[Index(column, row)]) : std::numeric_limits<double>::quiet_NaN();
  }
};

// Points that close holes (SurfacePoint::filled) do not count. Cells become larger than cell_m where the box would have more than 30 million.
TopRaster RasteriseTop(const PointCloud& cloud, const PlanIndex& points, const Eigen::AlignedBox2d& box, double cell_m);

}  // namespace skyquilt::buildings
