// Which way is up in a reconstruction: what photos and points say about the direction of gravity, without heights of tags. A fit through positions
// alone tilts the world when tagged heights drift while the flight goes one way.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "prepare/georeference/camera_up.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

// One kind of evidence. Directions are unit vectors in the model's frame.
struct UpEvidence {
  std::string kind = {};  // stated, gimbal, cameras, ground or wall
  int n = 0;              // photos or points behind it
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // inverse covariance of `up`, 1/rad^2; no information along `up` itself
  bool used = true;                                       // false: shown only, because better evidence of the same kind exists

  // One standard deviation in radians, both axes together; infinity when a direction is undetermined.
  double Sigma() const;
};

struct Gravity {
  std::vector<UpEvidence> evidence;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();          // all used evidence together
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // likewise

  double Sigma() const;
};

// Gimbal angles: every tagged photo gives an up vector; an error of the mounting that is common to all photos is estimated with it
// (kGimbalCommon_deg). Empty when no photo has angles.
std::vector<UpEvidence> GimbalEvidence(const std::vector<input::PreparedPhoto>& photos);
// Camera axes: the right axis of every camera is level, and cameras that look about straight down are meant to look exactly down; common error
// kCameraCommon_deg. The start, turned photos and cameras that all look the same way: camera_up.h. Empty for no photos.
std::vector<UpEvidence> CameraEvidence(const std::vector<input::PreparedPhoto>& photos, const UpByTagsFunction& tags_up = {});
// The plane of the sparse points, as seen from `rough_up`: ground slopes, hence the accuracy of kGroundSlope_deg. Empty for fewer than 30 points or
// points on a line. Any order of points gives the same result up to rounding.
std::vector<UpEvidence> GroundEvidence(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& rough_up);

struct GravityHints {
  UpByTagsFunction tags_up = {};                  // see FindHeldCameras
  std::optional<Eigen::Vector3d> stated_up = {};  // by the user, in the model's frame, not zero: then all else is shown only
};

// All of them, weighted by their information. Gimbal angles replace the camera axes when at least half of the photos have them. The plane of the
// points counts as ground where it leans by at most kGroundAgrees_deg against these. One that is upright, as far as all accuracies go, is a
// wall, which without gimbal angles says that up lies in it; any other plane does not count. A line of the log says so. Evidence that contradicts
// itself widens the result (Birge's ratio). `points` are in the model's frame, may be empty.
Gravity FindGravity(const std::vector<input::PreparedPhoto>& photos, const std::vector<Eigen::Vector3d>& points, const GravityHints& hints = {});

constexpr double kGimbalCommon_deg = 0.25;
constexpr double kCameraCommon_deg = 2.0;
constexpr double kGroundSlope_deg = 4.0;
constexpr double kGroundAgrees_deg = 30.0;
constexpr double kStatedUp_deg = 0.5;

}  // namespace skyquilt::prepare::georeference
