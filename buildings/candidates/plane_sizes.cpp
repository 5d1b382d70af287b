#include "buildings/candidates/plane_sizes.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace skyquilt::buildings {
namespace {

// Found on two simulated towns at this GSD whose colours were ignored. Crowns: mean 2.4 to 6 m2, two largest planes below 0.6 of small outlines, four
// below 0.78. Houses with bent roofs at the edge of a survey: mean from 4.2 m2; others from 7 m2; sheds are one or two planes.
constexpr double kFoundAt_m = 0.185;
constexpr double kLeastScale = 0.2, kMostScale = 1.5;
struct CrownLimits {
  double mean_m2, two, four;
};
constexpr CrownLimits kWithColours = {4.0, 0.5, 0.75}, kWithoutColours = {5.5, 0.6, 0.78};
constexpr double kOneMainPlane = 0.5;  // a roof with such a plane may be small
constexpr double kSmallOutline_m2 = 40.0;

}  // namespace

PlaneSizes SizesOf(std::span<const RoofPlane> planes, double outline_m2) {
  std::vector<double> areas;
  for (const RoofPlane& plane : planes) areas.push_back(plane.area_m2 * std::max(plane.normal.z(), 0.0));
  std::sort(areas.begin(), areas.end(), std::greater<>());
  double sum = 0.0, squares = 0.0;
  PlaneSizes sizes;
  sizes.outline_m2 = outline_m2;
  for (size_t i = 0; i < areas.size(); ++i) {
    sum += areas[i];
    squares += areas[i] * areas[i];
    if (i < 1) sizes.largest += areas[i] / outline_m2;
    if (i < 2) sizes.two += areas[i] / outline_m2;
    if (i < 4) sizes.four += areas[i] / outline_m2;
  }
  sizes.mean_m2 = sum > 0.0 ? squares / sum : 0.0;
  return sizes;
}

bool LooksLikeCrown(const PlaneSizes& sizes, double gsd_m, bool colours_tell) {
  if (sizes.largest >= kOneMainPlane) return false;
  const double scale = std::clamp(gsd_m / kFoundAt_m, kLeastScale, kMostScale);
  const CrownLimits& limits = colours_tell ? kWithColours : kWithoutColours;
  if (sizes.outline_m2 < scale * kSmallOutline_m2 && sizes.two < limits.two && sizes.four < limits.four) return true;
  return sizes.mean_m2 < scale * limits.mean_m2;
}

}  // namespace skyquilt::buildings
