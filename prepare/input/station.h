// A photo with a pose, and what its tags say about its place: the input of the geo-reference.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/survey/exif.h"

namespace skyquilt::prepare::input {

// Lists of stations are in name order.
struct Station {
  std::string name;  // of the photo, for messages
  geo::Rigid3d cam_from_model;
  std::optional<geo::Geodetic> gps;           // tagged position of the camera; the height is NaN when the tag has none
  std::optional<double> time_s;               // of capture, from any common epoch
  std::optional<double> relative_altitude_m;  // tagged height above take-off
  bool rtk = false;                           // the tag has centimetre accuracy
  // Stated or typical accuracy of the tag, one standard deviation per axis in metres; only its relation to that of other tags counts.
  double horizontal_sigma_m = 3.0;
  double vertical_sigma_m = 4.5;
  std::optional<Eigen::Vector3d> up_in_cam = {};  // unit vector by the tagged gimbal angles
  std::string position_file = {};                 // that `gps` comes from, as in PhotoTags
};

Station MakeStation(const std::string& name, const geo::Rigid3d& cam_from_model, const survey::PhotoTags& tags);

// Up in the camera's frame (x right, y down, z forward) for gimbal angles in degrees: pitch -90 looks straight down, positive roll lowers the right
// side. Up does not depend on the yaw.
Eigen::Vector3d UpInCamera(double pitch_deg, double roll_deg);

// Flight of each station, numbered from 0 by time: a pause longer than `gap_s` starts a new flight. Stations without time belong to the flight of the
// station before them in name order.
std::vector<int> SplitFlights(const std::vector<Station>& stations, double gap_s);
int CountFlights(const std::vector<int>& flight);

}  // namespace skyquilt::prepare::input
