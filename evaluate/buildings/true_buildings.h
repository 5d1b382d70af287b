// The true buildings of a simulated survey, in the survey's frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "buildings/building.h"
#include "core/geo/geodetic.h"

namespace skyquilt::evaluate::buildings {

// The truth is described like what was measured.
using skyquilt::buildings::Building;
using skyquilt::buildings::BuildingSet;
using skyquilt::buildings::Measure;
using skyquilt::buildings::Polygon;
using skyquilt::buildings::RoofKind;

// What stands together: houses that share a wall are one outline, because photos cannot tell owners apart.
struct TrueBuilding {
  int id = 0;
  std::string shape, kind;           // "rectangle", "l", ...; "house", ...
  RoofKind roof = RoofKind::kOther;  // of the largest part
  Polygon walls;                     // survey ENU, metres, as all that follows
  double ground_z_m = 0.0;
  double eave_z_m = 0.0;                // of the largest part
  std::vector<double> other_eaves_z_m;  // of pitched parts hardly smaller than that, any of which may be measured as the largest
  double ridge_z_m = 0.0;               // highest of all parts; flat roofs: the deck
  double length_m = 0.0;                // of the rectangle around the walls along the building's axes; the longer side
  double width_m = 0.0;
  double yaw_deg = 0.0;  // of the length axis, counter-clockwise from east
  double area_m2 = 0.0;  // of the walls
  bool inside = true;    // the whole plan is inside the surveyed area
};

struct TrueBuildings {
  std::vector<TrueBuilding> outlines;
  std::optional<Polygon> area;  // that was surveyed, ENU; nothing when it is not known
};

// Reads truth/buildings.json: "outlines", or one rectangle per row of "buildings" in surveys of earlier versions. The frame and the surveyed area are
// read from simulate.json in the folder above; see SurveyFromTruth. An error of the geo-reference is not corrected. Throws base::InputError.
TrueBuildings ReadTrueBuildings(const std::filesystem::path& buildings_json, const geo::Geodetic& survey_origin);

}  // namespace skyquilt::evaluate::buildings
