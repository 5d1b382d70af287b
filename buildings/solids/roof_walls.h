// Vertical walls between roofs of different heights, and between roofs and the ground.
#pragma once

#include <cstdint>
#include <vector>

#include "buildings/solids/roof_map.h"

namespace skyquilt::buildings {

// A corner of a wall: a level at a vertex of the map.
struct WallCorner {
  uint32_t vertex = 0;
  int level = 0;

  bool operator==(const WallCorner&) const = default;
};
using Wall = std::vector<WallCorner>;  // counter-clockwise seen from its lower side

// Walls of one plane that share an edge are one wall. They contain every level of a column that they pass.
std::vector<Wall> WallsOf(const RoofMap& roof);

}  // namespace skyquilt::buildings
