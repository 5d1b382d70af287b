// Areas that polygons share, for the scores of buildings. Polygons far from each other are not intersected.
#pragma once

#include <span>
#include <vector>

#include "buildings/geometry/polygon.h"

namespace skyquilt::evaluate {

// Square metres.
double SharedArea(const buildings::Polygon& a, const buildings::Polygon& b);
double TotalArea(std::span<const buildings::Polygon> disjoint);
// Of the polygons that lie near `place`, what lies within it; overlaps among them count once.
double CoveredArea(const buildings::Polygon& place, std::span<const buildings::Polygon> by);
// What is left of the polygon without `taken`.
std::vector<buildings::Polygon> Without(const buildings::Polygon& polygon, std::span<const buildings::Polygon> taken);

}  // namespace skyquilt::evaluate
