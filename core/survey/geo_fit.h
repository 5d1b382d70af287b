// How a survey was placed on Earth: the fit to the photos' GPS tags, the evidence for the direction of gravity, what is known of the accuracy, and
// problems that a user must know of.
#pragma once

#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/geo/place_accuracy.h"

namespace skyquilt::survey {

// What one kind of evidence says about the direction of gravity.
struct GravityEvidence {
  std::string kind = {};  // stated, gimbal, cameras, ground, wall or gps_heights
  int n = 0;              // photos, points or tags behind it
  // Its up against the frame's final up: how far it leans towards east and north; NaN when it says nothing.
  double lean_east_deg = 0.0;
  double lean_north_deg = 0.0;
  double sigma_deg = 0.0;  // accuracy given to it (both axes together); NaN when it says nothing
  double weight = 0.0;     // 0..1, share of the information on gravity; 0: shown only
};

// A length that was measured on site, and the same in the survey.
struct ScaleBarFit {
  std::string a, b;  // labels of marks, or points of the model
  double length_m = 0.0;
  double measured_m = 0.0;
};

// How well the reconstruction fits the GPS tags, after the corrections below.
struct GeoFit {
  int n_matches = 0;    // photos with GPS and pose
  int n_inliers = 0;    // of these, tags that agree with the fit
  double rmse_m = 0.0;  // 3-D, over the inliers
  double rmse_horizontal_m = 0.0;
  double rmse_vertical_m = 0.0;
  double scale = 1.0;      // metres per model unit
  double tag_lag_s = 0.0;  // the tags show the position of this time before the photo; 0: none, or not estimated
  double tag_lag_sigma_s = std::numeric_limits<double>::quiet_NaN();  // NaN: not estimated
  std::vector<double> flight_vertical_offset_m = {};                  // added to the GPS heights of flight i, at its middle; empty: no correction
  std::vector<double> flight_vertical_drift_m = {};  // rise of the tagged heights of flight i from its first to its last photo; empty: no correction
  geo::PlaceAccuracy accuracy = {};
  std::vector<GravityEvidence> gravity = {};
  double tags_alone_tilt_deg = std::numeric_limits<double>::quiet_NaN();  // tilt of a fit to the tags alone against the final frame
  std::vector<ScaleBarFit> scale_bars = {};                               // those that could be measured
  bool adjusted_to_tags = false;                                          // the poses are those of a bundle adjustment with the tags
};

// Blur and bending that a flight may cause and that the geo-reference cannot repair. NaN: unknown.
struct FlightChecks {
  double speed_mps = std::numeric_limits<double>::quiet_NaN();   // median over ground
  std::string speed_source = {};                                 // "speed tags", or "positions and times"; empty: unknown
  double readout_ms = std::numeric_limits<double>::quiet_NaN();  // of the camera's sensor, from a table; 0: global or mechanical shutter
  std::string camera_name = {};                                  // make and model as tagged
  double smear_px = std::numeric_limits<double>::quiet_NaN();    // motion during read-out at full image size: speed * readout / GSD
  double dome_m = std::numeric_limits<double>::quiet_NaN();      // height of the middle of the camera positions above their edge, against the tags
  double dome_sigma_m = std::numeric_limits<double>::quiet_NaN();
  double k1 = std::numeric_limits<double>::quiet_NaN();  // first radial coefficient of the camera with most photos
  double k1_sigma = std::numeric_limits<double>::quiet_NaN();
};

// Something found in a survey that its user must know.
struct Problem {
  std::string code;          // stable name for programs, e.g. "swapped_coordinates"
  std::string finding;       // what is wrong, a sentence without its full stop
  std::string advice;        // what to do, likewise
  bool about_place = false;  // concerns the place on Earth: an error when prepare.require_georeference is set
  bool operator==(const Problem&) const = default;
};

// The geo-reference part of survey.json. Numbers that are NaN are stored as null.
nlohmann::ordered_json ToJson(const geo::PlaceAccuracy& accuracy);
nlohmann::ordered_json ToJson(const GeoFit& fit);
nlohmann::ordered_json ToJson(const FlightChecks& checks);
nlohmann::ordered_json ToJson(const Problem& problem);

// Throw nlohmann::json::exception for missing keys and wrong types.
geo::PlaceAccuracy PlaceAccuracyFromJson(const nlohmann::json& value);
GeoFit GeoFitFromJson(const nlohmann::json& value);
FlightChecks FlightChecksFromJson(const nlohmann::json& value);
Problem ProblemFromJson(const nlohmann::json& value);

}  // namespace skyquilt::survey
