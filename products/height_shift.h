// Turns the survey's heights in the cells of a map into those of the map's vertical system.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "core/gis/map_grid.h"
#include "core/scene/map_heights.h"

namespace skyquilt::products {

// Latitude and longitude are exact at nodes 50 m apart at most and bilinear between them, which is within a millimetre of the cell's place; there the
// undulation is exact.
class HeightShift {
 public:
  // Keeps references to both.
  HeightShift(const scene::MapHeights& heights, const gis::MapGrid& grid);

  // Converts whole rows from first_row on; cells without data keep that value. Rows must not go back.
  void AddTo(int first_row, float no_data, std::span<float> height_m);

 private:
  const std::vector<geo::Geodetic>& NodesOf(int node_row);

  const scene::MapHeights& heights_;
  const gis::MapGrid& grid_;
  int step_ = 1, columns_ = 0;                       // cells between nodes; nodes of a row
  std::map<int, std::vector<geo::Geodetic>> nodes_;  // only the last rows of nodes that were used
};

}  // namespace skyquilt::products
