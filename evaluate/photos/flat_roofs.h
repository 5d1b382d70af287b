// Measures how flat the flat roofs of a simulated survey come out. A colour-only reconstruction gets their height about right but leaves them rough.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

#include "core/base/packed_bytes.h"
#include "evaluate/photos/photo_scorer.h"

namespace skyquilt::evaluate::photos {

inline constexpr double kRoofRim_m = 1.0;         // left out along the walls, where parapets stand
inline constexpr double kDeckTolerance_m = 0.2;   // true points farther than this from the deck's true height are on something that stands there
inline constexpr size_t kFewestRoofPoints = 50;   // roofs with fewer points are not measured
inline constexpr double kLevelRoofNormal = 0.99;  // smallest upward component of true normals on a deck

// The part of a flat roof that is measured: its footprint without the rim.
struct RoofArea {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // ENU metres
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();   // unit, along the length
  Eigen::Vector2d half_m = Eigen::Vector2d::Zero();  // half length and half width

  bool Contains(const Eigen::Vector2d& point) const;
};

// Flat roofs in truth/buildings.json that are wider than twice the rim. Throws base::InputError for a file that cannot be read or is damaged.
std::vector<RoofArea> ReadFlatRoofs(const std::filesystem::path& buildings_json);

// Spread of the vertical distances to the plane z = a + b x + c y that fits the points best; NaN for fewer than three points.
struct PlaneSpread {
  double rms_m = kNotMeasured;
  double nmad_m = kNotMeasured;  // 1.4826 times the median distance from the median: of most points, when some are far off
};
PlaneSpread SpreadAboutPlane(std::span<const Eigen::Vector3d> points);

struct FlatRoofScore {
  int roofs = 0;       // measured ones
  PlaneSpread spread;  // medians over them
};

// Collects the field's surface points (median depth) on flat roofs over several photos.
class FlatRoofPoints {
 public:
  FlatRoofPoints() = default;
  explicit FlatRoofPoints(std::vector<RoofArea> areas) : areas_(std::move(areas)), points_(areas_.size()) {}
  // findings: result of ScorePhoto for this task. A pixel counts when it is scored, its true class is roof, its true normal is vertical and its true
  // surface point is in the area of a roof: which pixels count does not depend on the rendering.
  void Add(const HeldOutPhoto& task, const PhotoResult& findings);
  FlatRoofScore Result() const;
  // The points, so that others of the same areas can go on from here. Load throws base::UnreadableBytes when there are more or fewer areas.
  void Save(base::BytePacker* out) const;
  void Load(base::ByteUnpacker* in);

 private:
  struct RoofPoint {
    Eigen::Vector3d rendered;  // ENU metres
    double true_z_m;
  };
  std::vector<RoofArea> areas_;
  std::vector<std::vector<RoofPoint>> points_;  // one list per area
};

}  // namespace skyquilt::evaluate::photos
