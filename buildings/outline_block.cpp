#include "buildings/outline_block.h"

#include <cmath>

#include "buildings/solids/build_solids.h"

namespace skyquilt::buildings {
namespace {

constexpr double kFilled = 0.9;      // share of its rectangle that a rectangular outline fills, as its corners are rounded
constexpr double kRim_gsd = 0.5;     // standard deviation of the rim of a roof
constexpr double kStairs_gsd = 2.0;  // outlines follow cells of about this size

}  // namespace

bool LeavesCorners(const Candidate& candidate, const Shape& shape) {
  const double rectangle_m2 = (shape.u.back() - shape.u.front()) * (shape.v.back() - shape.v.front());
  return Area(candidate.outline) < kFilled * rectangle_m2;
}

void FollowOutline(const Candidate& candidate, double gsd_m, Building* building) {
  // The outline as it is where nothing simpler has the same holes.
  const Polygon simple = Simplified(candidate.outline, kStairs_gsd * gsd_m);
  building->footprint = simple.outer.size() >= 3 && simple.holes.size() == candidate.outline.holes.size() ? simple : candidate.outline;
  Measures& measures = building->measures;
  const double top = measures.ridge_m.value, ground = building->shape.ground_z;
  building->lod12 = ExtrudeBlock(building->footprint, ground, top);
  building->lod22 = building->lod12;
  building->lod22_valid = !building->lod12.Empty() && CheckSolid(building->lod12).empty();
  const double area = Area(building->footprint), height = top - ground;
  const double area_sigma = kRim_gsd * gsd_m * Perimeter(building->footprint);
  measures.footprint_m2 = {area, area_sigma};
  measures.roof_m2 = {area, area_sigma};
  measures.volume_m3 = {area * height, std::hypot(area_sigma * height, area * measures.height_m.sigma)};
}

}  // namespace skyquilt::buildings
