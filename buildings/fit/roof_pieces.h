// The upper envelope of a shape's roofs as convex pieces, exact: for areas and volumes that can be differenced. For solids see
// solids/build_solids.h, whose facets are joined and cleaned.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/building.h"

namespace skyquilt::buildings {

// A convex polygon in u, v under one plane z = slope . uv + offset.
struct RoofPiece {
  std::vector<Eigen::Vector2d> outline;  // counter-clockwise
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double offset = 0.0;
};
// Pieces do not overlap and together cover the walls' rectangles.
std::vector<RoofPiece> RoofPieces(const Shape& shape);

struct RoofTotals {
  double plan_m2 = 0.0;    // the footprint
  double sloped_m2 = 0.0;  // of the roof over it
  double volume_m3 = 0.0;  // between it and ground_z; negative where the roof is below
};
RoofTotals TotalsOf(const Shape& shape);

}  // namespace skyquilt::buildings
