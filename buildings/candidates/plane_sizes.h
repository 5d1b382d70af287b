// Whether the planes of a candidate are large enough for a roof. The crown of a tree falls into many small planes, whatever its colour.
#pragma once

#include <span>

#include "buildings/planes/grow_planes.h"

namespace skyquilt::buildings {

struct PlaneSizes {
  double mean_m2 = 0.0;  // of the plane that a random place of the roof lies on: sum a^2 / sum a, areas seen from above
  double largest = 0.0;  // shares of the outline: of the largest plane, the two and the four largest
  double two = 0.0, four = 0.0;
};
PlaneSizes SizesOf(std::span<const RoofPlane> planes, double outline_m2);

// colours_tell: vegetation of this survey can be told by its colour too, so that a doubtful candidate is believed.
bool LooksLikeCrown(const PlaneSizes& sizes, double outline_m2, bool colours_tell);

}  // namespace skyquilt::buildings
