// A prepared survey, the result of the prepare stage and the input of all later ones: photos with pose, time and exposure in one local ENU frame,
// their cameras and the sparse points. On disk it is a folder with survey.json (readable text), points.ply and kept_points.ply (the points, for any
// viewer), tracks.bin (which photos saw them) and directions.json.
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
#include "core/geo/height_reference.h"
#include "core/geo/transform.h"
#include "core/survey/control_fit.h"
#include "core/survey/directions.h"
#include "core/survey/geo_fit.h"
#include "core/survey/point_tracks.h"

namespace skyquilt::survey {

struct ExposureSettings {
  std::optional<double> time_s;
  std::optional<double> f_number;
  std::optional<double> iso;
};

struct Photo {
  std::string name;                  // path relative to Survey::photo_root, '/' separated; unique
  std::string mask;                  // absolute path of the mask or empty
  int camera = 0;                    // index into Survey::cameras
  geo::Rigid3d cam_from_enu;         // camera looks along +z, y down; metres
  std::optional<geo::Geodetic> gps;  // from the photo's tags, without correction; the height is NaN when the tags have none
  // What the fit adds to the tagged position (ENU metres): the lag of the tags along the track, offset and drift of their heights.
  Eigen::Vector3d gps_correction_m = Eigen::Vector3d::Zero();
  std::optional<double> relative_altitude_m;  // XMP tag, above take-off; only for checks
  std::optional<double> time_s;               // seconds since the first photo's capture
  ExposureSettings exposure;
  double agl_m = 0.0;           // camera height above the sparse points below it; NaN when unknown
  double gps_residual_m = 0.0;  // distance between the camera centre and its corrected GPS tag (horizontal if heights are not used); NaN without GPS
  bool gps_inlier = false;      // the tag agrees with the fit
  int flight = 0;               // index of the flight the photo belongs to
  // Held out for evaluation: trains and starts no field. It took part in finding poses and points unless Survey::resected_holdout.
  bool is_test = false;
};

struct SparsePoint {
  Eigen::Vector3d x_in_enu = Eigen::Vector3d::Zero();
  std::array<uint8_t, 3> rgb{};
  float error_px = 0.0F;  // mean reprojection error in pixels of the full photos, of held-out ones too unless Survey::resected_holdout
  int track_length = 0;   // number of training photos that observed it; of all photos in surveys of older programs; 0 when not known
};

// Ground truth of a simulated survey; absolute paths. Those with an initializer are empty where the simulation has none, and in surveys that were
// simulated or prepared by versions without them.
struct Truth {
  std::filesystem::path depth_folder;  // <photo stem>.tiff, z-depth (along the camera's z axis) in metres, NaN = sky
  std::filesystem::path buildings_json;
  std::filesystem::path exposure_json;
  std::filesystem::path normals_folder = {};     // <photo stem>.png, core/image/normal_image.h
  std::filesystem::path classes_folder = {};     // <photo stem>.png, core/survey/surface_class.h
  std::filesystem::path surface_ply = {};        // mesh with a class per face
  std::filesystem::path masks_folder = {};       // <photo name>.png, 0 on a moving car or its shadow; only for photos that show one
  std::filesystem::path ortho_tif = {};          // true orthophoto, RGBA
  std::filesystem::path edge_targets_json = {};  // where slanted edges are painted on the ground
};

struct Survey {
  geo::Geodetic origin;        // of the ENU frame
  bool georeferenced = false;  // false: levelled local frame, of unknown scale without scale bars; the origin has no meaning
  // What the heights of the frame, the origin's among them, are measured from; core/survey/tagged_heights.h decides it. Computations take them
  // for ellipsoidal whatever it is; unknown in surveys of older programs.
  geo::HeightReference height_reference = geo::HeightReference::kUnknown;
  std::filesystem::path photo_root;  // absolute
  std::vector<camera::Camera> cameras;
  std::vector<Photo> photos;              // registered photos only, in name order
  std::vector<std::string> unregistered;  // names of photos without a pose
  // Held-out photos were placed last, by points that they had not helped to place (prepare.holdout_poses); else they took part as all others.
  bool resected_holdout = false;
  std::vector<SparsePoint> points;
  DominantDirections directions;
  PointTracks tracks;  // of `points`, training photos only (in surveys of older programs all photos); may be empty
  // Sparse points that nothing may use which leads to a scene: only scores of finished scenes. Structure from motion used them as all others.
  std::vector<SparsePoint> kept_points;
  PointTracks kept_tracks;  // of `kept_points`, held-out photos among them; may be empty
  GeoFit fit;
  ControlFit control;  // agreement with ground control and check points
  FlightChecks checks;
  std::vector<Problem> problems;  // found while preparing, the worst first
  std::optional<Truth> truth;

  // Which photos saw each point is known, of `points` and of `kept_points`.
  bool HasTracks() const;
  double MedianAgl() const;  // metres; NaN when no photo has one
};

// Throw base::InputError if the folder cannot be written or read, or its content is damaged (NaN in a pose included). Surveys of older programs are
// loaded without kept points and tracks.
void SaveSurvey(const Survey& survey, const std::filesystem::path& folder);
Survey LoadSurvey(const std::filesystem::path& folder);

}  // namespace skyquilt::survey
