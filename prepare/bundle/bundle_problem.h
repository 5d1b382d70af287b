// All unknowns of a survey while its poses are found: photos, lenses and points, and which observations agree with them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/transform.h"
#include "prepare/bundle/adjusted_lens.h"

namespace skyquilt::prepare::bundle {

// A feature of a photo as part of a track.
struct TrackEntry {
  uint32_t photo = 0;  // index of the photo
  uint32_t feature = 0;
};

// Features of different photos that show the same point. Entries of track t are entries[first[t]] to entries[first[t + 1] - 1], in photo order.
struct FeatureTracks {
  std::vector<uint32_t> first = {0};
  std::vector<TrackEntry> entries;

  size_t size() const { return first.size() - 1; }
};

struct BundlePhoto {
  Eigen::Quaterniond cam_from_enu = Eigen::Quaterniond::Identity();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // ENU metres
  bool placed = false;                               // has a pose
  bool held = false;                                 // keeps it in adjustments
  int lens = 0;                                      // index of its lens
  // Photos with the same number were taken at once by the cameras of a rig, and have one pose (shots.h); negative: alone.
  int shot = -1;
  geo::Rigid3d cam_from_rig = {};  // metres, as ENU
  // What tags say.
  std::optional<Eigen::Vector3d> gps;  // ENU metres; a height without a tag is that of the others
  Eigen::Vector3d gps_sigma = Eigen::Vector3d(3.0, 3.0, 5.0);
  std::optional<Eigen::Quaterniond> tagged_rotation;  // cam_from_enu
};

struct BundleLens {
  Lens numbers{};
  Lens initial{};
  camera::Camera camera;      // to begin with
  double focal_sigma = 0.05;  // of the initial focal length, relative, one standard deviation
  double unit_px = 1.0;       // errors are counted in pixels of a photo of 1600 pixels width, so that thresholds suit every camera
  bool hold_focal = false;    // the focal length stays what it is
  bool exact = false;         // nothing of it is adjusted
  bool free_centre = false;   // the principal point is adjusted too
};

struct BundleProblem {
  std::vector<BundlePhoto> photos;
  std::vector<BundleLens> lenses;
  FeatureTracks tracks;
  std::vector<Eigen::Vector2d> pixel;  // per entry of the tracks
  std::vector<Eigen::Vector3d> point;  // per track, ENU metres
  std::vector<char> has_point;         // per track
  std::vector<char> agrees;            // per entry: in a placed photo and near the projection of its point
  std::vector<double> sigma;           // per entry, accuracy of its pixel in units of the lens; empty: 1 for all

  // Error of an entry against a point, in units; negative when the point is behind the camera. The photo must be placed.
  double Error(uint32_t entry, const Eigen::Vector3d& x_in_enu) const {
    const BundlePhoto& photo = photos[tracks.entries[entry].photo];
    const BundleLens& lens = lenses[static_cast<size_t>(photo.lens)];
    const Eigen::Vector3d x_in_cam = photo.cam_from_enu * (x_in_enu - photo.centre);
    if (!(x_in_cam.z() > 1e-6)) return -1.0;
    return (Project(lens.numbers, x_in_cam, nullptr) - pixel[entry]).norm() / lens.unit_px;
  }
};

// A point whose place has been measured.
struct KnownPoint {
  uint32_t track = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // ENU metres; finite
  Eigen::Vector3d sigma = Eigen::Vector3d::Ones();  // metres; infinite: nothing is known along this axis
};

constexpr double kUnitWidth_px = 1600.0;

}  // namespace skyquilt::prepare::bundle
