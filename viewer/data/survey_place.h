// Where a survey's ENU frame lies, how two of them lie to each other, and how the project's maps lie to it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>

#include "core/base/errors.h"
#include "core/geo/enu_frame.h"
#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/geo/utm.h"

namespace skyquilt::viewer {

struct SurveyPlace {
  geo::Geodetic origin;
  bool georeferenced = false;
};

// The rigid transform of coordinates in `main` to those in `other`. Two local frames without geo-reference count as the same one. Nothing when only
// one has a geo-reference, or an origin is not on Earth.
std::optional<geo::Rigid3d> OtherFromMain(const SurveyPlace& main, const SurveyPlace& other);

// Coordinates of a project's maps, turned into its ENU frame.
class SurveyFrame {
 public:
  // Not geo-referenced: maps are in local metres already.
  SurveyFrame(const geo::Geodetic& origin, bool georeferenced) {
    if (georeferenced) frame_.emplace(origin);
  }
  // Throws base::InputError when only one of map and survey is geo-referenced, so that the map's place is unknown.
  void RequireFits(bool map_georeferenced, const std::filesystem::path& map) const {
    if (map_georeferenced == frame_.has_value()) return;
    throw base::InputError(map,
                           frame_ ? "has local coordinates, but the survey has a geo-reference" : "has a CRS, but the survey has no geo-reference",
                           "Make it again from this survey with 'skyquilt render' or 'skyquilt surface'");
  }
  // Easting, northing (of the map's zone) and height above the ellipsoid; local x, y, z without geo-reference.
  Eigen::Vector3d EnuFromMap(const Eigen::Vector2d& map_xy, double height_m, const geo::UtmZone& zone) const {
    if (!frame_) return {map_xy.x(), map_xy.y(), height_m};
    return frame_->EnuFromGeodetic(geo::GeodeticFromUtm(map_xy, height_m, zone));
  }

 private:
  std::optional<geo::EnuFrame> frame_;
};

}  // namespace skyquilt::viewer
