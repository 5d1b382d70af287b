// What OpenDroneMap's options mean depends on the flight: known once the poses are.
#pragma once

#include <filesystem>

#include "coordinator/project/settings.h"
#include "core/survey/survey.h"
#include "odm/request.h"

namespace skyquilt::odm {

// Median over the photos of a pixel's size on the ground, metres; NaN when no photo's height above it is known.
double PhotoGsd(const survey::Survey& survey);

// Metres per cell for --orthophoto-resolution and --dem-resolution (centimetres): what was asked for, but not finer than the photos' pixels unless
// --ignore-gsd is given. Rounded to a tenth of a millimetre, so that poses that differ by a hair give the same maps.
struct MapCells {
  double orthophoto_m = 0.0, heights_m = 0.0;
};
MapCells CellsOf(const Request& request, const survey::Survey& survey);

// The hull of the cameras' positions widened by --auto-boundary-distance (0: by half of the median flying height), as GeoJSON in longitude and
// latitude, or local metres without geo-reference. `file` is written only when its content changes. Throws base::InputError.
void WriteAutoBoundary(const survey::Survey& survey, double distance_m, const std::filesystem::path& file);

// Throws base::InputError when this boundary lies beside all cameras and points: the maps would find that only after the training.
void RequireBoundaryMeets(const survey::Survey& survey, const std::filesystem::path& boundary);

}  // namespace skyquilt::odm
