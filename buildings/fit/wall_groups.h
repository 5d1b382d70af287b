// Points of walls, and of the rims of roofs above them.
//
// What the fused surface shows of a wall (seen on simulated towns, in sections across hundreds of walls): just below its rim a roof's side is steep,
// sharp and repeats to a quarter of a GSD, whether or not anything below was seen, since photos from above show the rim against the ground. An
// overhang hides the wall below it; there the surface goes back from the rim to the wall between 4 and 15 GSD below the rim. Farther down it is the
// wall, but set back where few views saw it: depths at grazing angles lie a little behind the true surface, and only many views from different sides
// correct that. A low wall under an overhang is not seen at all: the surface goes down from the rim to the ground.
#pragma once

#include <vector>

#include "buildings/building.h"
#include "buildings/fit/fit_points.h"
#include "buildings/fit/observations.h"

namespace skyquilt::buildings {

struct WallSelection {
  double gsd_m = 0.1;
  double overhang_m = 0.0;  // of pitched roofs: where rims are looked for
  double window_m = 1.0;    // points farther from the line are not used
};

// How far the surface of a wall lies behind the wall, in GSD, by the number of views that saw it relative to that of the roof.
double SetBack_gsd(double views, double roof_views);

// Where the side of a rim is, in GSD below the roof's plane at the rim, and how far in front of the true rim the surface is there: it rounds thin
// eaves away and pads solid corners. sloped: the roof falls towards the rim.
struct Rim {
  double from_gsd, to_gsd, off_gsd;
};
Rim RimOf(bool pitched, bool sloped);

// One group per line and side with enough points of the wall.
std::vector<Group> WallGroups(const FitPoints& points, const Shape& shape, const Parameters& parameters, const WallSelection& selection);

// One group per line, side and part with enough points of the roof's rim; where there are none, of the rim as the end of the roof's points.
std::vector<Group> EdgeGroups(const FitPoints& points, const Shape& shape, const Parameters& parameters, const WallSelection& selection);

}  // namespace skyquilt::buildings
