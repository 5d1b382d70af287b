// A prepared survey: photos with pose, time and exposure in one local ENU frame, their cameras and the sparse points.
// On disk a folder: survey.json (everything but the points, readable by people) and points.ply (opens in any viewer).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/geodetic.h"
#include "core/geo/transform.h"

namespace skyquilt::survey {

struct ExposureSettings {
  std::optional<double> time_s;
  std::optional<double> f_number;
  std::optional<double> iso;
};

struct Photo {
  std::string name;                           // path relative to Survey::photo_root, '/' separated; unique
  std::string mask;                           // absolute path of the mask or empty
  int camera = 0;                             // index into Survey::cameras
  geo::Rigid3d cam_from_enu;                  // camera looks along +z, y down; metres
  std::optional<geo::Geodetic> gps;           // as tagged (XMP preferred), height as tagged
  std::optional<double> relative_altitude_m;  // XMP, above take-off: a cross-check, not truth
  std::optional<double> time_s;               // seconds since the first photo's capture
  ExposureSettings exposure;
  double agl_m = 0.0;           // camera height above the sparse points below it; NaN when unknown
  double gps_residual_m = 0.0;  // |fitted - tagged| camera centre; NaN without GPS
  bool gps_inlier = false;
  int flight = 0;        // index of the flight the photo belongs to
  bool is_test = false;  // held out: never trained on
};

struct SparsePoint {
  Eigen::Vector3d x_in_enu = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb{};
  float error_px = 0.0F;
  int track_length = 0;
};

struct GeoFit {
  int n_matches = 0;  // photos with GPS and pose
  int n_inliers = 0;
  double rmse_m = 0.0;  // 3-D, over the inliers
  double rmse_horizontal_m = 0.0;
  double rmse_vertical_m = 0.0;
  double scale = 1.0;                            // metres per model unit
  std::vector<double> flight_vertical_offset_m;  // added to the tags of flight i before the fit; empty: one flight, none needed
};

// Where a simulated survey keeps its ground truth; folders relative to nothing (absolute).
struct Truth {
  std::filesystem::path depth_folder;  // <photo stem>.tiff, metres along z of the camera ("z_depth"), NaN = sky
  std::filesystem::path buildings_json;
  std::filesystem::path exposure_json;
};

struct Survey {
  geo::Geodetic origin;              // of the ENU frame
  bool georeferenced = false;        // false: local frame, unknown scale, origin meaningless
  std::filesystem::path photo_root;  // absolute
  std::vector<camera::Camera> cameras;
  std::vector<Photo> photos;              // registered photos only, in name order
  std::vector<std::string> unregistered;  // names of photos without a pose
  std::vector<SparsePoint> points;
  GeoFit fit;
  std::optional<Truth> truth;

  double MedianAgl() const;  // metres; NaN when no photo has one
};

// Throws base::InputError if the folder cannot be written / read or the content is damaged (NaN pose included).
void SaveSurvey(const Survey& survey, const std::filesystem::path& folder);
Survey LoadSurvey(const std::filesystem::path& folder);

}  // namespace skyquilt::survey
