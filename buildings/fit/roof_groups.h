// Points of the planes of a shape's roofs.
#pragma once

#include <vector>

#include "buildings/building.h"
#include "buildings/fit/fit_points.h"
#include "buildings/fit/observations.h"

namespace skyquilt::buildings {

struct RoofSelection {
  double gsd_m = 0.1;
  double overhang_m = 0.0;  // of pitched roofs
  double window_m = 1.0;    // points farther from the roof are not used
};
// One group per plane with points. Left out are points near rims, ridges, valleys and steps, where the surface is rounded: within 1.5 GSD, and 1 m
// inside the rim of flat roofs, where parapets are.
std::vector<Group> RoofGroups(const FitPoints& points, const Shape& shape, const RoofSelection& selection);

// Sets the heights of flat roofs to their lowest strong level and those of other blocks to the median of their points.
void SetLevels(const FitPoints& points, double gsd_m, Shape* shape);

// Of the roof's points: the share within tolerance_m of the shape (roofs; walls up to a parapet's height), and a robust standard deviation of those
// on roofs.
struct RoofAgreement {
  double share_within = 0.0, residual_m = 0.0;
};
RoofAgreement AgreementOf(const FitPoints& points, const Shape& shape, double overhang_m, double tolerance_m);

}  // namespace skyquilt::buildings
