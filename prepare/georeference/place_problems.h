// Says in words what is wrong with the place of a survey, and what to do about it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/survey/geo_fit.h"
#include "prepare/georeference/tags/tag_checks.h"

namespace skyquilt::prepare::georeference {

// What a geo-reference found out, as far as its problems depend on it.
struct PlaceFindings {
  const survey::GeoFit& fit;
  std::vector<std::string> disagreeing = {};  // names of photos whose tags do not agree
  bool gimbal_used = false;
  bool one_line = false;
  HeightTags heights = HeightTags::kTagged;
  double tags_alone_sigma_deg = 0.0;  // accuracy of the tilt of a fit to the tags alone
  double gravity_sigma_deg = 0.0;     // of gravity without the tags
  double vertical_span_m = 0.0;       // range of the height errors that were found
  // Tags that do not agree with the result but with each other.
  int second_group = 0;         // their number; 0: none
  double second_group_m = 0.0;  // horizontal distance from the result
};

// For a survey that has a place; the worst first.
std::vector<survey::Problem> PlaceProblems(const PlaceFindings& findings);

survey::Problem ScaleUncertain(double scale_percent);
constexpr const char* kScaleUncertain = "scale_uncertain";

// For a survey that gets a local frame: why, as a problem. `reason` is a sentence without its full stop.
survey::Problem NoPlace(const std::string& code, const std::string& reason, const std::string& advice);
// The same of photos above one another (tags/photo_column.h), and of tags with one latitude and longitude (TagsAboveOneAnother). `up`: unit vector in
// the model's frame.
survey::Problem ColumnProblem();
survey::Problem OnePlaceProblem(const std::vector<input::PreparedPhoto>& photos, const Eigen::Vector3d& up);

// Scale bars have given the local frame its scale: problems of NoPlace say so from now on.
void SayLengthsAreMetres(std::vector<survey::Problem>* problems);

// Why the accuracy does not allow to claim a place; empty when it does. On one line a few tags that agree by chance pass for a fit, so there at least
// half of the tags have to agree.
std::vector<survey::Problem> TooUncertain(const survey::GeoFit& fit, bool one_line);

// Fit and gravity may disagree by this much, the scale be uncertain by this much, before a warning.
constexpr double kWarnConflict_deg = 2.0;
constexpr double kWarnScale_percent = 2.0;

}  // namespace skyquilt::prepare::georeference
