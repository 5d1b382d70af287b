// Where the roofs of a building end or jump, on the borders between cells of the raster.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "buildings/shape/roof_raster.h"

namespace skyquilt::buildings {

enum class RoofEdge : uint8_t { kNone, kOutline, kStep };

// Edges that run across one axis. A lane is a row of cells along that axis; border b of a lane is before its cell b.
struct EdgesAcross {
  int lanes = 0, borders = 0;
  std::vector<RoofEdge> edge;  // [lane][border]

  RoofEdge At(int lane, int border) const { return edge[static_cast<size_t>(lane) * static_cast<size_t>(borders) + static_cast<size_t>(border)]; }
};

// [0]: across u (walls u = constant), [1]: across v. A step is a jump of more than 0.6 m, a metre between roofs of 45 degrees, that slopes on both
// sides do not explain: neither ridges nor steep roofs are steps.
std::array<EdgesAcross, 2> FindRoofEdges(const RoofRaster& raster);

// Share of the lanes between two positions of the other axis with an edge within reach_m of `at`. only: kNone counts both kinds.
double ShareWithEdge(const RoofRaster& raster, const EdgesAcross& edges, int axis, double at, double from, double to, double reach_m,
                     RoofEdge only = RoofEdge::kNone);

}  // namespace skyquilt::buildings
