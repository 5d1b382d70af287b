// How well a survey agrees with its ground control and check points.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace skyquilt::survey {

struct ControlMarkFit {
  std::string photo;                                           // Photo::name
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();             // as marked, in the stored photo; centre of the top-left pixel (0.5, 0.5)
  double error_px = std::numeric_limits<double>::quiet_NaN();  // distance to the projection of the estimated point; NaN: the photo has no pose
  bool used = false;                                           // false: no pose, or it contradicts the other marks
};

enum class ControlUse {
  kControl,   // used for the fit
  kCheck,     // only compared
  kRejected,  // a control point that contradicts the others
  kUnseen     // fewer than two usable marks: no estimate
};

inline const char* NameOf(ControlUse use) {
  switch (use) {
    case ControlUse::kControl:
      return "control";
    case ControlUse::kCheck:
      return "check";
    case ControlUse::kRejected:
      return "rejected";
    case ControlUse::kUnseen:
      return "unseen";
  }
  return "";
}

struct ControlPointFit {
  std::string label;
  ControlUse use = ControlUse::kControl;
  Eigen::Vector3d given_in_enu = Eigen::Vector3d::Zero();  // metres in Survey's frame; z is NaN when no height was given
  Eigen::Vector3d error_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  // estimated less given, east north up; NaN: unknown
  Eigen::Vector3d sigma_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  // of the error, accuracy of `given` included
  // Error when this control point is left out of the fit; NaN: not computed.
  Eigen::Vector3d left_out_error_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  double error_px = std::numeric_limits<double>::quiet_NaN();  // root mean square over used marks
  double gsd_m = std::numeric_limits<double>::quiet_NaN();     // ground sampling distance of the photos there: mean of depth over focal length
  // Accuracy of the given coordinates, one standard deviation: per horizontal axis, and of the height; NaN: unknown.
  Eigen::Vector2d given_sigma_m = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<ControlMarkFit> marks;
};

// Empty `points`: the survey has no control points.
struct ControlFit {
  std::string file;                     // where the points come from
  std::string crs;                      // name of the file's coordinate system
  std::string heights;                  // "ellipsoid", "egm96", or the name of its vertical system
  bool placed = false;                  // the place on Earth comes from the points; false: from GPS tags, and the points are only compared
  bool adjusted = false;                // by bundle adjustment; false: by a similarity alone
  std::vector<ControlPointFit> points;  // in file order
};

// The control points' part of survey.json. Numbers that are NaN are stored as null.
nlohmann::ordered_json ToJson(const ControlFit& fit);

// Throws nlohmann::json::exception for missing keys and wrong types, std::invalid_argument for vectors of a wrong length, an unknown use, two points
// of one label, and a horizontal place or a marked pixel that is unknown.
ControlFit ControlFitFromJson(const nlohmann::json& value);

}  // namespace skyquilt::survey
