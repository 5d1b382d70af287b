// From the model's own frame to local ENU by GPS tags, or to a plain local frame without them.
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

// One registered photo, in name order.
struct Station {
  geo::Rigid3d cam_from_model;
  std::optional<geo::Geodetic> gps;
  std::optional<double> time_s;  // any common epoch
  bool rtk = false;
};

struct Georeference {
  bool ok = false;     // false: local frame, unknown scale
  std::string reason;  // why not, for people
  geo::Geodetic origin;
  geo::Similarity3d enu_from_model;
  survey::GeoFit fit;
  std::vector<int> flight;         // per station
  std::vector<double> residual_m;  // per station, NaN without GPS
  std::vector<double> residual_up_m;
  std::vector<char> inlier;  // per station
};

// Flights are numbered by time: a pause longer than `gap_s` starts another one. Stations without time join the one before them in name order.
std::vector<int> SplitFlights(const std::vector<Station>& stations, double gap_s);

// Origin: median tagged position. The fit is RANSAC over Umeyama (core/geo/robust_similarity.h); flights whose heights disagree by more than
// kFlightOffsetTrigger_m get one vertical offset each (reference: the RTK flight, else the largest).
Georeference FitToGps(const std::vector<Station>& stations, const PrepareOptions& options);
// The model is taken to be in ENU about `origin` already; residuals against the tags are reported all the same.
Georeference KeepExactFrame(const std::vector<Station>& stations, const geo::Geodetic& origin, const PrepareOptions& options);
// Without GPS: z up by the cameras' common viewing direction (nadir) or the plane of their centres, origin at the points' median, scale such
// that the median camera-to-point depth is kLocalDepth. `points` are in the model's frame; may be empty.
geo::Similarity3d LocalFrame(const std::vector<Station>& stations, const std::vector<Eigen::Vector3d>& points);

constexpr double kFlightOffsetTrigger_m = 3.0;
constexpr double kLocalDepth = 40.0;

}  // namespace skyquilt::prepare
