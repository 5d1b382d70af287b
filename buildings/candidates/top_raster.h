// The surface seen from above on a small raster: how high it is, and how green.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <vector>

#include "buildings/candidates/cell_mask.h"
#include "buildings/candidates/plan_grid.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

// Excess green (2g - r - b) / (r + g + b): grey 0, lawns 0.1 to 0.3; 0 for black.
double ExcessGreen(const SurfacePoint& point);

// Cell (column, row) covers origin + cell_m * [column, column + 1) x [row, row + 1); rows go north.
struct TopRaster {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // ENU
  double cell_m = 0.0;
  int columns = 0, rows = 0;
  std::vector<float> top_z;  // ENU z of the highest point; between points, up to about one spacing, the median of those around; NaN: none
  std::vector<float> green;  // mean over the points near the top, likewise

  size_t Index(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column); }
  size_t size() const { return top_z.size(); }
  Eigen::Vector2d CentreOf(size_t cell) const {
    const auto width = static_cast<size_t>(columns);
    return origin + cell_m * Eigen::Vector2d(static_cast<double>(cell % width) + 0.5, static_cast<double>(cell / width) + 0.5);
  }
  // -1 outside.
  int64_t CellAt(const Eigen::Vector2d& enu) const {
    const Eigen::Vector2d at = ((enu - origin) / cell_m).array().floor();
    if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < columns && at.y() < rows)) return -1;
    return static_cast<int64_t>(at.y()) * columns + static_cast<int64_t>(at.x());
  }
  // NaN outside.
  double TopAt(int column, int row) const {
    if (column < 0 || row < 0 || column >= columns || row >= rows) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(top_z[Index(column, row)]);
  }
  CellMask EmptyMask() const { return {columns, rows}; }
};

// Points that close holes (SurfacePoint::filled) do not count. Cells become larger than cell_m where the box would have more than 30 million.
TopRaster RasteriseTop(const PointCloud& cloud, const PlanGrid& points, const Eigen::AlignedBox2d& box, double cell_m);

}  // namespace skyquilt::buildings
