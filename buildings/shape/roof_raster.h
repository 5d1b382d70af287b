// Heights of a building's roofs on a grid along its axes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "buildings/shape/axis_points.h"

namespace skyquilt::buildings {

// Cell (column, row) covers cell_m times [column, column + 1) along u and [row, row + 1) along v, from origin.
struct RoofRaster {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  double cell_m = 1.0;
  int columns = 0, rows = 0;
  std::vector<float> height;     // of the highest roof, ENU; NaN: not covered, or a gap too wide to be closed
  std::vector<uint8_t> covered;  // 1: inside the outline

  size_t Index(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column); }
  Eigen::Vector2d Centre(int column, int row) const { return origin + cell_m * Eigen::Vector2d(column + 0.5, row + 0.5); }
  double CellArea() const { return cell_m * cell_m; }
  // Cells whose centres lie between two positions along u (axis 0) or v (axis 1): [first, last).
  struct Range {
    int first = 0, last = 0;
  };
  Range Between(int axis, double from, double to) const;
};

// Around the outline with a margin of a few cells. Empty when there is no outline.
RoofRaster MakeRoofRaster(const AxisPoints& points, double gsd_m);

}  // namespace skyquilt::buildings
