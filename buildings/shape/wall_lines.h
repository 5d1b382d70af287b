// Lines along a building's axes on which its walls may stand.
#pragma once

#include <array>
#include <vector>

#include "buildings/shape/axis_points.h"
#include "buildings/shape/roof_edges.h"
#include "buildings/shape/roof_raster.h"

namespace skyquilt::buildings {

struct WallLine {
  double at = 0.0;       // metres along the axis
  double wall_m2 = 0.0;  // steep points that face along the axis, as area
  double edge_m = 0.0;   // length of roof edges and steps
};

// [0]: u = constant, [1]: v = constant; rising, at least two each, none nearer than about a metre to the next. Walls win over the edges of the roofs
// above them, which overhang. At most kMostLines per axis by evidence, besides the outermost.
using WallLines = std::array<std::vector<WallLine>, 2>;
inline constexpr int kMostLines = 8;

WallLines FindWallLines(const AxisPoints& points, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges);

}  // namespace skyquilt::buildings
