#include "buildings/outline_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "buildings/solids/build_solids.h"

namespace skyquilt::buildings {
namespace {

constexpr double kFilled = 0.9;       // share of its rectangle that a rectangular outline fills, as its corners are rounded
constexpr double kRim_gsd = 0.5;      // standard deviation of the rim of a roof
constexpr double kRounded_gsd = 2.0;  // details of a roof's rim below this are noise
constexpr double kStairs = 1.5;       // and so are the steps of the raster that found the outline, in its cells

// Of outlines along raster cells no edge is shorter than a cell.
double ShortestEdge(const std::vector<Eigen::Vector2d>& ring) {
  double shortest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < ring.size(); ++i) shortest = std::min(shortest, (ring[(i + 1) % ring.size()] - ring[i]).norm());
  return shortest;
}

// Outlines that were given stay as they are, and so do those of which nothing simpler has the same courtyards.
Polygon WithoutStairs(const Candidate& candidate, double gsd_m) {
  const Polygon& outline = candidate.outline;
  if (candidate.given) return outline;
  Polygon simple = Simplified(outline, std::max(kRounded_gsd * gsd_m, kStairs * ShortestEdge(outline.outer)));
  return simple.outer.size() >= 3 && simple.holes.size() == outline.holes.size() ? simple : outline;
}

}  // namespace

bool LeavesCorners(const Candidate& candidate, const Shape& shape) {
  const double rectangle_m2 = (shape.u.back() - shape.u.front()) * (shape.v.back() - shape.v.front());
  return Area(candidate.outline) < kFilled * rectangle_m2;
}

void FollowOutline(const Candidate& candidate, double gsd_m, const geo::PlaceAccuracy& accuracy, Building* building) {
  building->footprint = WithoutStairs(candidate, gsd_m);
  Measures& measures = building->measures;
  const double top = measures.ridge_m.value, ground = building->shape.ground_z;
  building->lod12 = ExtrudeBlock(building->footprint, ground, top);
  building->lod22 = building->lod12;
  building->lod22_valid = !building->lod12.Empty() && CheckSolid(building->lod12).empty();
  const double area = Area(building->footprint), height = top - ground;
  const double scale = std::isfinite(accuracy.scale_percent) ? 0.01 * accuracy.scale_percent : 0.0;
  const double area_sigma = std::hypot(kRim_gsd * gsd_m * Perimeter(building->footprint), 2.0 * scale * area);
  measures.footprint_m2 = {area, area_sigma};
  measures.roof_m2 = {area, area_sigma};
  measures.volume_m3 = {area * height, std::hypot(area_sigma * height, area * measures.height_m.sigma)};
}

}  // namespace skyquilt::buildings
