// Where the drone takes its photos, with which exposure, and what its tags say about both.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geo/transform.h"
#include "simulate/place_spec.h"

namespace skyquilt::simulate {

struct PhotoPlan {
  std::string name;           // "IMG_0001.jpg", in the order of capture
  geo::Rigid3d cam_from_enu;  // true pose
  double yaw_deg = 0.0;       // gimbal, clockwise from north
  double pitch_deg = -90.0;   // -90: straight down
  double roll_deg = 0.0;
  double relative_altitude_m = 0.0;                           // above the take-off point, as the barometer has it
  Eigen::Vector3d tagged_position = Eigen::Vector3d::Zero();  // ENU metres, true position plus GPS noise
  double time_s = 0.0;                                        // since the first photo
  int line = 0;                                               // flight line; nadir lines come first
  bool oblique = false;
  double exposure_time_s = 0.0;
  double f_number = 2.8;
  double iso = 100.0;
  bool exposure_tagged = true;     // the three above stand in its tags
  double gain = 1.0;               // of linear light by the three above, relative to the median photo
  double development_gain = 1.0;   // of linear light as it really was, relative to normal exposure
  double color_drift_stops = 0.0;  // of the white balance: red gets so much more, blue so much less
};

// Nadir lines run north and south with the wide side of the photo across them: one flight over the whole area when all altitudes agree,
// otherwise one per block. Oblique lines follow. takeoff_z_m: ENU height of the ground the drone started from.
std::vector<PhotoPlan> PlanFlight(const PlaceSpec& place, double takeoff_z_m);

// Factors on linear light that the photo really gets, relative to normal exposure: red, green, blue.
std::array<double, 3> LightRgb(const PhotoPlan& photo);

// cam_from_enu of a camera at `position` whose optical axis has this yaw (clockwise from north) and pitch; roll turns it about that axis.
geo::Rigid3d PoseFromGimbal(const Eigen::Vector3d& position, double yaw_deg, double pitch_deg, double roll_deg);

}  // namespace skyquilt::simulate
