// Rectangles of cells between wall lines that may be parts of a building.
#pragma once

#include <cstdint>
#include <vector>

#include "buildings/shape/wall_cells.h"

namespace skyquilt::buildings {

// All rectangles of cells of the mask ([v][u]) that cannot grow on any side, in rising order. An L gives two that overlap, a ring four.
std::vector<CellRectangle> MaximalRectangles(const std::vector<uint8_t>& mask, int columns, int rows);

// What is left of `a` without `b`, when it is one rectangle: not inside, not cut in two or to an L, not the whole of it.
bool Without(const CellRectangle& a, const CellRectangle& b, CellRectangle* rest);

bool Overlap(const CellRectangle& a, const CellRectangle& b, CellRectangle* both);
inline bool IsWithin(const CellRectangle& a, const CellRectangle& b) {
  return a.u0 >= b.u0 && a.u1 <= b.u1 && a.v0 >= b.v0 && a.v1 <= b.v1;
}

// Label per cell of pieces of roof that hang together: their heights do not jump on the line between them; -1 outside. Pieces smaller than least_m2,
// such as stair housings on a deck, go to the neighbour with the longest common border.
std::vector<int> RoofRegions(const WallCells& cells, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges, double least_m2);

// Candidates for the parts: maximal rectangles of all cells, of each region, of each region with those above it (a podium runs on below its tower),
// and what remains of one without another (a wing that ends at the main part). At most kMostRectangles, the largest by area.
inline constexpr int kMostRectangles = 48;
std::vector<CellRectangle> CandidateRectangles(const WallCells& cells, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges,
                                               double least_m2);

}  // namespace skyquilt::buildings
