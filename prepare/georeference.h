// Places a structure-from-motion model on Earth. Its frame has arbitrary position, rotation and scale; GPS tags of the photos give the similarity
// transform to local ENU. Without tags the model gets a level local frame of unknown scale.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"
#include "core/survey/survey.h"
#include "prepare/prepare_options.h"

namespace skyquilt::prepare {

// A photo with a pose. Lists of stations are in name order.
struct Station {
  geo::Rigid3d cam_from_model;
  std::optional<geo::Geodetic> gps;  // tagged position of the camera
  std::optional<double> time_s;      // of capture, from any common epoch
  bool rtk = false;                  // the tag has centimetre accuracy
};

struct Georeference {
  bool ok = false;     // false: local frame, unknown scale
  std::string reason;  // why not, for the log; empty when ok
  geo::Geodetic origin;
  geo::Similarity3d enu_from_model;
  survey::GeoFit fit;
  std::vector<int> flight;            // per station, from 0
  std::vector<double> residual_m;     // per station: distance from tag to fitted position; NaN without GPS
  std::vector<double> residual_up_m;  // its upward part, fitted less tagged
  std::vector<char> inlier;           // per station: 1 if the tag is within the threshold
};

// Flight of each station, numbered from 0 by time: a pause longer than `gap_s` starts a new flight. Stations without time belong to the flight of the
// station before them in name order.
std::vector<int> SplitFlights(const std::vector<Station>& stations, double gap_s);

// Fits the model to the tags by RANSAC with Umeyama's method (core/geo/robust_similarity.h); the origin is the median tagged position. If the tagged
// heights of flights disagree by more than kFlightOffsetTrigger_m, each flight gets a vertical offset relative to a reference: the flight with most
// RTK tags, else with most tags. ok is false when fewer than three photos are tagged or when the tags do not determine the transform.
Georeference FitToGps(const std::vector<Station>& stations, const PrepareOptions& options);
// For a model that is already in ENU about `origin`: keeps its frame and only computes the residuals of the tags.
Georeference KeepExactFrame(const std::vector<Station>& stations, const geo::Geodetic& origin, const PrepareOptions& options);
// Frame for a model without GPS. Up: opposite to the cameras' common viewing direction (nadir flight), otherwise the normal of the plane of their
// centres. Origin: median of the points. Scale: the median depth of points in the cameras becomes kLocalDepth. `points` are in the model's frame; may
// be empty.
geo::Similarity3d LocalFrame(const std::vector<Station>& stations, const std::vector<Eigen::Vector3d>& points);

constexpr double kFlightOffsetTrigger_m = 3.0;
constexpr double kLocalDepth = 40.0;  // local units, in place of metres

}  // namespace skyquilt::prepare
