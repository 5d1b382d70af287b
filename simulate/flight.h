// Plans the drone's photos: true poses, exposures, and the values written into the tags, which have errors as in a real survey.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/geo/transform.h"
#include "simulate/place_spec.h"

namespace skyquilt::simulate {

struct GimbalAngles {
  double yaw_deg = 0.0;
  double pitch_deg = 0.0;
  double roll_deg = 0.0;
};

struct PhotoPlan {
  std::string name;           // "IMG_0001.jpg", in the order of capture
  geo::Rigid3d cam_from_enu;  // true pose
  double yaw_deg = 0.0;       // gimbal, clockwise from north
  double pitch_deg = -90.0;   // -90: straight down
  double roll_deg = 0.0;
  bool position_tagged = true;                                // the tags have the position and relative_altitude_m
  double relative_altitude_m = 0.0;                           // above the take-off point, with the barometer's error
  Eigen::Vector3d tagged_position = Eigen::Vector3d::Zero();  // ENU metres, true position plus GPS noise
  std::optional<GimbalAngles> tagged_gimbal;                  // empty: no such tags
  HeightTags tagged_heights = HeightTags::kTrue;              // of the position and of relative_altitude_m
  bool coordinates_swapped = false;                           // the tags have latitude and longitude in each other's place
  std::optional<double> tagged_speed_mps;                     // over ground
  double time_s = 0.0;                                        // since the first photo
  int line = 0;                                               // flight line; nadir lines come first
  bool oblique = false;
  double exposure_time_s = 0.0;
  double f_number = 2.8;
  double iso = 100.0;
  bool exposure_tagged = true;     // the photo's tags have the three values above
  double gain = 1.0;               // factor on linear light by the three values above, relative to the median photo
  double development_gain = 1.0;   // the true factor on linear light, relative to normal exposure
  double color_drift_stops = 0.0;  // of the white balance: added to red, subtracted from blue
  bool true_depth = false;         // its true depth, normals and classes are written
  bool finds_points = true;        // sparse points are sought in it; false: it only sees those found in other photos
};

// Nadir lines run north and south with the wide side of the photo across them: one flight over the whole area when all blocks have the same altitude,
// otherwise one per block. Oblique lines follow. takeoff_z_m: ENU height of the ground at take-off. The tags have noise, but not the errors of
// place.tag_faults, which ApplyTagFaults adds. Throws base::UsageError for a place with another flight (simulate/flights/level_flight.h).
std::vector<PhotoPlan> PlanFlight(const PlaceSpec& place, double takeoff_z_m);

// "IMG_0001.jpg" for the first photo, 0.
std::string PhotoName(size_t index);
// Sets the pose at `position` (ENU metres) with the photo's angles, and its tags with the errors of GPS and barometer.
void PlacePhoto(const PlaceSpec& place, double takeoff_z_m, const Eigen::Vector3d& position, base::Random& random, PhotoPlan& photo);
// Sets the settings of the exposures and the true light of all photos, in the order of capture.
void ExposePhotos(const PlaceSpec& place, std::vector<PhotoPlan>& photos);

// True factors on linear light relative to normal exposure: red, green, blue.
std::array<double, 3> LightRgb(const PhotoPlan& photo);

// cam_from_enu of a camera at `position` (ENU metres). Yaw is clockwise from north, pitch -90 looks straight down, roll turns about the optical axis.
geo::Rigid3d PoseFromGimbal(const Eigen::Vector3d& position, double yaw_deg, double pitch_deg, double roll_deg);

// The angles for which PoseFromGimbal has this rotation; the position has no influence. Yaw and roll are in [-180, 180] and pitch in [-90, 90]. Near
// pitch -90 and 90 yaw and roll turn about nearly the same axis: a small change of the pose may change both by a lot, but their pose is as accurate
// as elsewhere.
GimbalAngles GimbalFromPose(const geo::Rigid3d& cam_from_enu);

}  // namespace skyquilt::simulate
