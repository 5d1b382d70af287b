// What poses are seeded from: photos with tags and features, and the verified matches of pairs.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/geodetic.h"
#include "core/geo/transform.h"

namespace skyquilt::prepare::poses {

struct SeedPhoto {
  uint32_t image_id = 0;  // in COLMAP's database; unique
  uint32_t camera_id = 0;
  std::string name;
  std::optional<geo::Geodetic> gps;                    // tagged position of the camera; the height is NaN when the tag has none
  double horizontal_sigma_m = 3.0;                     // accuracy of the tag, one standard deviation per axis
  double vertical_sigma_m = 4.5;                       // likewise
  std::optional<double> yaw_deg, pitch_deg, roll_deg;  // of the gimbal: clockwise from north; -90 looks straight down; right side down
  std::optional<double> relative_altitude_m = {};      // tagged height above take-off
  int shot = -1;                                       // of the rig's cameras at once (prepare/bundle/shots.h); negative: alone
  geo::Rigid3d cam_from_rig = {};                      // metres
  std::vector<Eigen::Vector2f> features;               // pixels of the stored photo (core/camera/camera.h)
};

struct SeedLens {
  camera::Camera camera;       // to begin with
  bool focal_is_known = true;  // from the photo's tags; false: a guess from the width of the photo
  double focal_sigma = 0.05;   // of a known focal length, relative, one standard deviation
  bool exact = false;          // nothing of it is adjusted
};

// Features `first` of image a and `second` of image b that agree with one geometry of the two views.
struct PairMatches {
  uint32_t image_a = 0, image_b = 0;
  std::vector<std::array<uint32_t, 2>> features;
};

struct SeedInput {
  std::vector<SeedPhoto> photos;
  std::map<uint32_t, SeedLens> cameras;  // by camera id
  std::vector<PairMatches> pairs;
};

}  // namespace skyquilt::prepare::poses
