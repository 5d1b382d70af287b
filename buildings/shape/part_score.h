// How well a set of rectangles explains the roofs of a building: each gets the roof that fits its points, and the whole is compared with the raster.
#pragma once

#include <map>
#include <vector>

#include "buildings/building.h"
#include "buildings/fit/roof_choice.h"
#include "buildings/shape/roof_raster.h"
#include "buildings/shape/wall_cells.h"

namespace skyquilt::buildings {

struct ScoredShape {
  std::vector<CellRectangle> rectangles;
  Shape shape;        // lines that no part uses are left out; parts in the order of the rectangles
  double cost = 0.0;  // square metres that are not explained, and what the parameters cost; infinite: not allowed
};

// Remembers the roofs of rectangles, so that sets which differ in one of them are cheap to compare. Not for use by several threads.
class PartScorer {
 public:
  // axes: origin, yaw and ground of the shapes.
  PartScorer(const Shape& axes, const WallCells& cells, const RoofRaster& raster, double gsd_m);

  // At least one rectangle. Not allowed: footprints of several pieces or with cells that touch at corners only; parts that are too small or narrow
  // beside others, or hardly rise above the one that they stand on; the same rectangle twice.
  ScoredShape Score(const std::vector<CellRectangle>& rectangles);

 private:
  bool IsAllowed(const std::vector<CellRectangle>& rectangles) const;
  static bool StandOut(const std::vector<CellRectangle>& rectangles, const Shape& shape);
  RoofFit RoofOf(const std::vector<CellRectangle>& rectangles, size_t own);
  Shape ShapeOf(const std::vector<CellRectangle>& rectangles);
  double Unexplained(const Shape& shape) const;

  Shape axes_;
  const WallCells& cells_;
  const RoofRaster& raster_;
  double gsd_m_;
  std::vector<uint8_t> rounded_;                         // [row][column] of the raster: beside the roofs' edge, where surfaces are rounded
  double parsimony_ = 1.0;                               // grows with the building: more area, more that is not noise but no part either
  std::map<std::vector<CellRectangle>, RoofFit> roofs_;  // of a rectangle followed by those taken from it
};

}  // namespace skyquilt::buildings
