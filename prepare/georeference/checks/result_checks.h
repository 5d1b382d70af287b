// Compares a finished survey with what the photos' tags know but did not decide: focal length, height above ground, directions of the cameras. GPS
// tags give a survey its scale along the ground. Where all photos look straight down, focal length and height above ground may still be wrong by one
// common factor, and little or nothing in the photos shows it.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "prepare/georeference/gimbal_check.h"
#include "prepare/poses/seed/take_off_height.h"

namespace skyquilt::prepare::georeference {

// One photo of the finished survey.
struct CheckedPhoto {
  Eigen::Quaterniond cam_from_enu = Eigen::Quaterniond::Identity();
  int camera = 0;
  double focal_px = 0.0;
  double longer_side_px = 0.0;
  double agl_m = std::numeric_limits<double>::quiet_NaN();
  std::optional<double> tagged_focal_px;
  std::optional<double> relative_altitude_m;
  std::optional<double> gimbal_yaw_deg, gimbal_pitch_deg, gimbal_roll_deg;
};

struct CheckedResult {
  std::vector<CheckedPhoto> photos;
  bool georeferenced = true;   // false: heights are no metres and directions are no compass directions
  bool own_poses = true;       // found from the photos; false: a given model, whose lens may have been calibrated
  bool by_control = false;     // control points decide about scale and heights
  double scale_percent = 0.0;  // accuracy of the scale, by the tags that agree
  // Standard deviation of the focal length by the photos alone, relative; NaN: unknown. Asked for only where RelativeAltitude does not confirm the
  // height; may be empty.
  std::function<double()> focal_sigma = {};
  GimbalVerdict gimbal;
};

struct Contradiction {
  // kNote: for the log; kWarning: something to look at; kPlace: what the survey says of itself may be wrong.
  enum class Urgency { kNote, kWarning, kPlace };
  std::string code;   // stable name for programs
  int n_photos = 0;   // that it concerns
  std::string found;  // what the result says, the start of a sentence
  std::string tags;   // what the tags say, the rest of it
  std::string cause;  // likely, a sentence without its full stop
  std::string remedy;
  Urgency urgency = Urgency::kWarning;

  survey::Problem ToProblem() const;
};

struct ResultChecks {
  std::vector<Contradiction> contradictions;
  poses::HeightAboveTakeOff height;
  // What the contradictions leave open: of every length, relative, and of heights of the ground. 0: nothing.
  double scale_doubt = 0.0;
  double height_doubt_m = 0.0;
  double tilt_doubt_deg = 0.0;  // likewise of the direction of up
};

ResultChecks CheckResult(const CheckedResult& result);

// Widens the stated accuracy to the doubts, puts the problems where they belong, and logs the notes. Nothing changes without contradictions.
void ApplyChecks(const ResultChecks& checks, survey::Survey& survey);

}  // namespace skyquilt::prepare::georeference
