// Coordinates of a project's maps, turned into its ENU frame.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geo/enu_frame.h"
#include "core/geo/utm.h"

namespace skyquilt::viewer {

class SurveyFrame {
 public:
  // Not geo-referenced: maps are in local metres already.
  SurveyFrame(const geo::Geodetic& origin, bool georeferenced) {
    if (!georeferenced) return;
    zone_ = geo::UtmZoneOf(origin);
    frame_.emplace(origin);
  }
  // Easting, northing (of the survey's zone) and height above the ellipsoid; local x, y, z without geo-reference.
  Eigen::Vector3d EnuFromMap(const Eigen::Vector2d& map_xy, double height_m) const {
    if (!frame_) return {map_xy.x(), map_xy.y(), height_m};
    return frame_->EnuFromGeodetic(geo::GeodeticFromUtm(map_xy, height_m, zone_));
  }

 private:
  std::optional<geo::EnuFrame> frame_;
  geo::UtmZone zone_;
};

}  // namespace skyquilt::viewer
