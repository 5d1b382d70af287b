// Sets of raster cells: distances to the nearest of them, dilation and erosion by discs, connected parts.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/grid.h"

namespace skyquilt::buildings {

using CellMask = base::Grid<uint8_t>;  // non-zero: in the set

// For each cell the nearest cell of the mask, by the distance of centres; -1 when the mask is empty. Exact but for rare ties of sequential Euclidean
// mapping (Danielsson 1980), there wrong by a fraction of a cell.
std::vector<int32_t> NearestCells(const CellMask& mask);
// Distance in cells between a cell and another.
inline double CellDistance(const CellMask& mask, size_t a, int32_t b) {
  if (b < 0) return std::numeric_limits<double>::infinity();
  const auto columns = static_cast<size_t>(mask.columns);
  const auto other = static_cast<size_t>(b);
  const double dx = static_cast<double>(a % columns) - static_cast<double>(other % columns);
  const double dy = static_cast<double>(a / columns) - static_cast<double>(other / columns);
  return std::hypot(dx, dy);
}

// Cells within this distance (in cells) of the mask; cells farther than it from all others. Beyond the raster nothing is inside.
CellMask Dilated(const CellMask& mask, double radius);
CellMask Eroded(const CellMask& mask, double radius);
// Erosion, then growth back: what is narrower than twice the radius goes, the rest keeps its shape.
CellMask Opened(const CellMask& mask, double radius);

// Cells of the parts connected by edges, each in rising order; parts in the order of their first cells.
std::vector<std::vector<uint32_t>> ConnectedParts(const CellMask& mask);

}  // namespace skyquilt::buildings
