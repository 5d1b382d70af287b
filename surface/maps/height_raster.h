// Heights on the grid of a map.
#pragma once

#include <limits>
#include <vector>

#include "core/gis/map_grid.h"

namespace skyquilt::surface {

inline constexpr float kNoHeight = std::numeric_limits<float>::quiet_NaN();

// Heights in map coordinates at the centres of the grid's cells, row 0 in the north; NaN: none. Steps on working cells, which have no place, take a
// base::Grid<float>.
struct HeightRaster {
  gis::MapGrid grid;
  std::vector<float> height_m;
};

}  // namespace skyquilt::surface
