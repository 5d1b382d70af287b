// A photo with a pose: its file, its image in the camera model, and what says where it was taken. The input of the geo-reference.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::input {

// Lists of them are in name order.
struct PreparedPhoto {
  PhotoFile file;    // with its tags as they were read
  size_t image = 0;  // index into the model's images
  geo::Rigid3d cam_from_model;
  std::optional<geo::Geodetic> gps;  // position of the camera by its tag or by what stands in for it; the height is NaN when that has none
  bool rtk = false;                  // `gps` has centimetre accuracy
  // Stated or typical accuracy of `gps`, one standard deviation per axis in metres; only its relation to that of other photos counts.
  double horizontal_sigma_m = 3.0;
  double vertical_sigma_m = 4.5;
  std::optional<Eigen::Vector3d> up_in_cam = {};  // unit vector by the tagged gimbal angles
};

// With the place that the file's tags say.
PreparedPhoto PreparePhoto(const PhotoFile& file, size_t image, const geo::Rigid3d& cam_from_model);

// Up in the camera's frame (x right, y down, z forward) for gimbal angles in degrees: pitch -90 looks straight down, positive roll lowers the right
// side. Up does not depend on the yaw.
Eigen::Vector3d UpInCamera(double pitch_deg, double roll_deg);

// Flight of each photo, numbered from 0 by time: a pause longer than `gap_s` starts a new flight. Photos without time belong to the flight of the
// photo before them in name order.
std::vector<int> SplitFlights(const std::vector<PreparedPhoto>& photos, double gap_s);
int CountFlights(const std::vector<int>& flight);

}  // namespace skyquilt::prepare::input
