// A grid of square cells in a plane, usually east and north of the survey's ENU frame; metres.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/grid.h"

namespace skyquilt::geo {

// Cell (column, row) covers origin + cell_m * [column, column + 1) x [row, row + 1): rows go north, unlike those of gis::MapGrid.
struct PlaneGrid : base::GridShape {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  double cell_m = 1.0;

  PlaneGrid() = default;
  PlaneGrid(const Eigen::Vector2d& corner, double side_m, int n_columns, int n_rows)
      : base::GridShape{n_columns, n_rows}, origin(corner), cell_m(side_m) {}
  // From the corner on, so that it covers the size.
  PlaneGrid(const Eigen::Vector2d& corner, double side_m, const Eigen::Vector2d& size)
      : PlaneGrid(corner, side_m, static_cast<int>(size.x() / side_m) + 1, static_cast<int>(size.y() / side_m) + 1) {}

  Eigen::Vector2d max() const { return origin + cell_m * Eigen::Vector2d(columns, rows); }
  Eigen::Vector2d Centre(int column, int row) const { return origin + cell_m * Eigen::Vector2d(column + 0.5, row + 0.5); }
  Eigen::Vector2d CentreOf(size_t cell) const {
    const auto width = static_cast<size_t>(columns);
    return Centre(static_cast<int>(cell % width), static_cast<int>(cell / width));
  }
  // Index of the cell at a place; -1 outside.
  int64_t CellAt(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d at = ((place - origin) / cell_m).array().floor();
    if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < columns && at.y() < rows)) return -1;
    return static_cast<int64_t>(Index(static_cast<int>(at.x()), static_cast<int>(at.y())));
  }
};

}  // namespace skyquilt::geo
