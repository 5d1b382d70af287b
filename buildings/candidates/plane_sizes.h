// Whether the planes of a candidate are large enough for a roof. The crown of a tree falls into many small planes, whatever its colour.
#pragma once

#include <span>

#include "buildings/planes/grow_planes.h"

namespace skyquilt::buildings {

struct PlaneSizes {
  double outline_m2 = 0.0;
  double mean_m2 = 0.0;                         // of the plane at a random place of the roof: sum a^2 / sum a, areas seen from above
  double largest = 0.0, two = 0.0, four = 0.0;  // shares of the outline: of the largest plane, the two and the four largest
};
PlaneSizes SizesOf(std::span<const RoofPlane> planes, double outline_m2);

// The patch of a round crown that is planar within the tolerance of planes, which follows the GSD, has an area in proportion to radius and tolerance;
// so limits of areas follow the GSD too. colours_tell: vegetation of this survey can be told by its colour, so that a doubtful candidate is believed.
bool LooksLikeCrown(const PlaneSizes& sizes, double gsd_m, bool colours_tell);

}  // namespace skyquilt::buildings
