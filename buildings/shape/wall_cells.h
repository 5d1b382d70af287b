// The cells between wall lines, and which of them are inside the building: a graph cut between roof and no roof.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "buildings/shape/wall_lines.h"

namespace skyquilt::buildings {

// Rectangle of cells: from line u0 to u1 and v0 to v1.
struct CellRectangle {
  int u0 = 0, u1 = 1, v0 = 0, v1 = 1;
  auto operator<=>(const CellRectangle&) const = default;
};

struct WallCells {
  std::array<std::vector<double>, 2> line;  // u and v of the lines, rising
  std::vector<uint8_t> inside;              // [v][u]

  int Columns() const { return static_cast<int>(line[0].size()) - 1; }
  int Rows() const { return static_cast<int>(line[1].size()) - 1; }
  size_t Index(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(Columns()) + static_cast<size_t>(column); }
  double Position(int axis, int number) const { return line[static_cast<size_t>(axis)][static_cast<size_t>(number)]; }
  double AreaOf(const CellRectangle& r) const { return (Position(0, r.u1) - Position(0, r.u0)) * (Position(1, r.v1) - Position(1, r.v0)); }
  double AreaOf(int column, int row) const { return AreaOf({column, column + 1, row, row + 1}); }
};

// Square metres of roof in each cell, [v][u].
std::vector<double> CoveredArea(const WallCells& cells, const RoofRaster& raster);

// Least cost of uncovered cells inside, covered cells outside, and borders without walls or edges. The result is the largest connected piece by area,
// without cells that touch at a corner only: there the cheapest cell changes.
WallCells CutCells(const WallLines& lines, const AxisPoints& points, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges);

}  // namespace skyquilt::buildings
