// Turns the coordinates of control points into WGS84 with ellipsoidal heights.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/geo/crs.h"
#include "core/geo/geodetic.h"
#include "prepare/control/reading/raw_control.h"

namespace skyquilt::prepare::control {

struct PointPlaces {
  std::string crs;                         // name of the system, horizontal and vertical
  std::string definition;                  // what PROJ resolves
  std::string heights;                     // see ControlPoints::heights
  std::vector<geo::Geodetic> places;       // per point; the height is NaN when the point has none
  std::map<size_t, LineProblem> problems;  // of points that can have no place, by their index
  std::vector<std::string> warnings;       // what was assumed
};

// `crs`: overrides the file's; empty: the file's. `heights` says what the points' heights are above:
//   "crs" or ""  as the system says; one without heights: the ellipsoid
//   "ellipsoid"  the WGS84 ellipsoid, whatever the system says
//   "egm96"      the geoid EGM96
// Heights are in the unit of the system's vertical part, without one in that of its horizontal part (feet where x is in feet), in metres with
// degrees. Throws base::UsageError for other `heights`, base::InputError, with the line and how to fix it, for a system that cannot be used.
PointPlaces PlacePoints(const RawControl& control, const std::string& crs, const std::string& heights);

}  // namespace skyquilt::prepare::control
