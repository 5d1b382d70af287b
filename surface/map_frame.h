// The coordinates of the maps and of all files of the surface but the 3D tiles: easting and northing of the survey's UTM (or UPS) zone and height
// above what products.vertical says; without geo-reference the local x, y, z.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/geo/enu_frame.h"
#include "core/geo/utm.h"
#include "core/scene/map_heights.h"
#include "core/scene/scene.h"

namespace skyquilt::surface {

class MapFrame {
 public:
  // Throws base::InputError when heights have to be converted and PROJ has no geoid.
  explicit MapFrame(const scene::SceneInfo& info, geo::Vertical vertical = geo::Vertical::kAsTagged);

  bool georeferenced() const { return frame_.has_value(); }
  const geo::UtmZone& zone() const { return zone_; }       // without meaning when not geo-referenced
  const geo::Geodetic& origin() const { return origin_; }  // with the survey's height
  const scene::MapHeights& heights() const { return heights_; }
  // Easting, northing, height in metres.
  Eigen::Vector3d MapFromEnu(const Eigen::Vector3d& x_in_enu) const;
  Eigen::Vector3d EnuFromMap(const Eigen::Vector3d& x_in_map) const;
  // The turn of directions in ENU near the middle of the scene, by the convergence of the meridians.
  const Eigen::Matrix3d& map_from_enu() const { return map_from_enu_; }
  // A direction in ENU near this place, turned by the convergence of the meridians; length 1.
  Eigen::Vector3f MapDirection(const Eigen::Vector3f& direction_enu) const;
  // Subtracted from coordinates in files of single precision: whole multiples of 100 m near the middle of the scene in easting and northing, 0 in
  // height, which OpenDroneMap's and CloudCompare's offsets do not have either; (0, 0, 0) without geo-reference.
  const Eigen::Vector3d& offset() const { return offset_; }

  // "EPSG:32617", or "local frame, metres" when not geo-referenced.
  std::string CrsName() const;
  // What heights are above, see scene::MapHeights::Name.
  std::string VerticalName() const;

 private:
  std::optional<geo::EnuFrame> frame_;
  geo::Geodetic origin_;
  geo::UtmZone zone_;
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d map_from_enu_ = Eigen::Matrix3d::Identity();
  scene::MapHeights heights_;
};

}  // namespace skyquilt::surface
