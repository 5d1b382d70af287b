// Where a map from photos ends: the outline of the ground that enough photos see.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/gis/map_grid.h"

namespace skyquilt::products {

// Lattice over the map: how many photos see each node. Nodes are the centres of the grid's cells.
struct SeenLattice {
  gis::MapGrid grid;
  std::vector<uint8_t> photos;  // [row][column]; 255: that many or more
};

// Simple rings in map coordinates, first points not repeated, around the ground that at least `least` photos see: outer ones counter-clockwise, holes
// clockwise. Parts and holes below 1 % of the largest part do not count, and notches narrower than some 2 % of its size are filled. The outline is
// smooth, and simplified within a quarter of a cell. It is moved inwards by crop_m, exact to about half a cell; what is narrower than twice that is
// cut off. No ring leaves the grid. Empty when nothing is left.
std::vector<std::vector<Eigen::Vector2d>> CutlineOf(const SeenLattice& seen, int least, double crop_m);

// Writes the rings of CutlineOf as layer "cutline": a polygon for each part, the largest first, with its area (area_m2, holes left out); the layer's
// description says what it is. In the CRS of the grid. Throws base::InputError when it cannot be written.
void WriteCutline(const std::vector<std::vector<Eigen::Vector2d>>& rings, const gis::MapGrid& grid, const std::filesystem::path& gpkg);

}  // namespace skyquilt::products
