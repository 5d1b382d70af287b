// Areas that polygons share, for the scores of buildings. Polygons far from each other are not intersected.
#pragma once

#include <span>
#include <vector>

#include "buildings/geometry/polygon.h"

namespace skyquilt::evaluate::buildings {

using skyquilt::buildings::Polygon;

// Square metres.
double SharedArea(const Polygon& a, const Polygon& b);
double TotalArea(std::span<const Polygon> disjoint);
// Of the polygons that lie near `place`, what lies within it; overlaps among them count once.
double CoveredArea(const Polygon& place, std::span<const Polygon> by);
// What is left of the polygon without `taken`.
std::vector<Polygon> Without(const Polygon& polygon, std::span<const Polygon> taken);

}  // namespace skyquilt::evaluate::buildings
