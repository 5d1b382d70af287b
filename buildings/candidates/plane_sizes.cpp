#include "buildings/candidates/plane_sizes.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace skyquilt::buildings {
namespace {

// Found on two simulated towns whose colours were ignored. Crowns: mean 2.4 to 6 m2, two largest planes below 0.6 of small outlines, four below 0.78.
// Houses with bent roofs at the edge of a survey: mean from 4.2 m2; others from 7 m2; sheds are one plane.
constexpr double kLeastMean_m2 = 4.0;
constexpr double kLeastMeanAlone_m2 = 5.5;  // when colours do not tell
constexpr double kOneMainPlane = 0.5;       // a roof with such a plane may be small
constexpr double kSmallOutline_m2 = 40.0, kLeastTwo = 0.6, kLeastFour = 0.78;

}  // namespace

PlaneSizes SizesOf(std::span<const RoofPlane> planes, double outline_m2) {
  std::vector<double> areas;
  for (const RoofPlane& plane : planes) areas.push_back(plane.area_m2 * std::max(plane.normal.z(), 0.0));
  std::sort(areas.begin(), areas.end(), std::greater<>());
  double sum = 0.0, squares = 0.0;
  PlaneSizes sizes;
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

bool LooksLikeCrown(const PlaneSizes& sizes, double outline_m2, bool colours_tell) {
  if (sizes.largest >= kOneMainPlane) return false;
  if (outline_m2 < kSmallOutline_m2 && sizes.two < kLeastTwo && sizes.four < kLeastFour) return true;
  return sizes.mean_m2 < (colours_tell ? kLeastMean_m2 : kLeastMeanAlone_m2);
}

}  // namespace skyquilt::buildings
