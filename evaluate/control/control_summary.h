// Statistics of a survey's ground control: how far it is from the control points it was fitted to, and from check points that it never saw.
// Errors are estimated less given position, metres in ENU. Rules:
//   check points within 2 ground sampling distances (GSD) horizontally and 3 vertically, as surveyors ask of photogrammetry;
//   a mean error above a quarter of the root mean square error on an axis is called systematic;
//   ASPRS Positional Accuracy Standards for Digital Geospatial Data, Edition 2 (2023): accuracy is stated as RMSE_H and RMSE_V, with the accuracy of
//   the check points' own survey included, from at least 30 check points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "core/survey/control_fit.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::control {

inline constexpr int kLeastCheckPoints = 30;  // for a statement of accuracy by ASPRS
inline constexpr double kMostHorizontal_gsd = 2.0, kMostVertical_gsd = 3.0;

// Of a group of points, east, north and up. NaN: no point has that.
struct ControlErrors {
  int n = 0;          // points with a horizontal error
  int n_heights = 0;  // of these, points with a height
  Eigen::Vector3d mean_m = Eigen::Vector3d::Constant(kNotMeasured);
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Constant(kNotMeasured);  // standard deviation about the mean; NaN for a single point
  Eigen::Vector3d rmse_m = Eigen::Vector3d::Constant(kNotMeasured);
  double rmse_horizontal_m = kNotMeasured;  // east and north together
  double rmse_vertical_m = kNotMeasured;
  double rmse_horizontal_gsd = kNotMeasured;  // of each point's error over its own GSD
  double rmse_vertical_gsd = kNotMeasured;

  // Per axis: the mean is above a quarter of the root mean square.
  std::array<bool, 3> Systematic() const;
  // Per axis: and above twice its standard error, so that it is hardly chance. With ten points the rule above holds by chance alone in almost half of
  // all cases.
  std::array<bool, 3> SystematicBeyondChance() const;
  // Within the rule on check points; nothing when the GSD is unknown. Heights count where there are any.
  std::optional<bool> WithinRule() const;
};

struct ControlSummary {
  ControlErrors control;   // used for the fit
  ControlErrors left_out;  // the same points, each when the fit does without it
  ControlErrors check;
  int n_rejected = 0, n_unseen = 0;
  // Accuracy of the check points' own survey, root mean square over them: east and north together, and heights. NaN: unknown.
  double given_horizontal_m = kNotMeasured, given_vertical_m = kNotMeasured;

  // The figures that tell how accurate the survey is: of check points, without them of points left out. Null without either.
  const ControlErrors* Judged() const;
};

ControlSummary SummariseControl(const survey::ControlFit& fit);
// A sentence or two. From 30 check points on it states RMSE_H and RMSE_V; with fewer it says how many there are.
std::string AccuracyStatement(const ControlSummary& summary);

}  // namespace skyquilt::evaluate::control
