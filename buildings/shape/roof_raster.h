// Heights of a building's roofs on a grid along its axes.
#pragma once

#include <cstdint>
#include <vector>

#include "buildings/shape/axis_points.h"
#include "core/geo/plane_grid.h"

namespace skyquilt::buildings {

// Columns along u, rows along v.
struct RoofRaster : geo::PlaneGrid {
  std::vector<float> height;     // of the highest roof, ENU; NaN: not covered, or a gap too wide to be closed
  std::vector<uint8_t> covered;  // 1: inside the outline

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
