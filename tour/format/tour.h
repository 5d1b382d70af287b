// A virtual tour: stops with a pose and a text, the ways between them, and things that are placed in the scene. docs/tour_format.md describes its
// file, tour.json. Positions are ENU metres of the project.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::tour {

constexpr int kTourVersion = 1;
constexpr size_t kMaxTourBytes = 1U << 20U;
constexpr size_t kMaxStops = 200, kMaxThings = 500, kMaxBranches = 20;
constexpr size_t kMaxTitleCharacters = 200, kMaxTextCharacters = 10'000, kMaxUrlCharacters = 2000;

enum class PathKind {
  kDirect,  // straight where that keeps its distance from the surface, else over what is in the way
  kOrbit,   // around a point
  kOver,    // over the highest that is between
  kJump,    // a cut
};

struct Path {
  PathKind kind = PathKind::kDirect;
  Eigen::Vector3d about = Eigen::Vector3d::Zero();  // of kOrbit
};

struct Pose {
  Eigen::Vector3d eye_enu = Eigen::Vector3d::Zero();
  Eigen::Quaterniond cam_from_enu = Eigen::Quaterniond::Identity();  // COLMAP's axes; norm 1 within 1e-6
  double fovy_deg = 60.0;
};

struct Link {
  std::string label, url;  // http:// or https:// only
};

struct Next {
  std::optional<std::string> to;  // none: the next stop of the list, after the last none
  Path path;
};

struct Branch {
  std::string to, label;
  Path path;
};

struct Stop {
  std::string id, title, text;
  std::optional<std::string> picture;  // name of an asset
  std::optional<Link> link;
  Pose pose;
  std::optional<double> exposure_stops;               // none: as the viewer has it
  std::optional<std::map<std::string, bool>> layers;  // none: left as they are
  std::vector<std::string> measurements;              // their ids
  double pause_s = 0.0;                               // how long the automatic tour stays
  std::optional<Next> next;                           // none: the tour ends here
  std::vector<Branch> branches;
};

enum class ThingKind { kLabel, kMarker, kModel };

struct Thing {
  std::string id;
  ThingKind kind = ThingKind::kLabel;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  std::string text;                               // of a label or marker; the name of a model
  std::optional<std::string> to;                  // of a marker: the stop that it leads to
  double yaw_deg = 0.0, scale = 1.0;              // of a model: clockwise from north; 1: metres as in its file
  std::string asset;                              // of a model
  std::optional<std::vector<std::string>> stops;  // where it is shown; none: always
};

struct AssetEntry {
  std::string name;  // the file's name when it was uploaded
  uint64_t bytes = 0;
};

struct Tour {
  std::string title;
  std::optional<std::string> start;  // none: the first stop
  std::vector<Stop> stops;
  std::vector<Thing> things;
  std::map<std::string, AssetEntry> assets;  // by the file's name in tour/assets/, see asset_name.h
};

}  // namespace skyquilt::tour
