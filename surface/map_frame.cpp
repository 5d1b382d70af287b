#include "surface/map_frame.h"

#include <Eigen/Geometry>

namespace skyquilt::surface {
namespace {

constexpr double kOffsetStep_m = 100.0;

// The rotation part of the map at x. The map stretches both horizontal directions alike (UTM and UPS are conformal) and does not stretch heights.
Eigen::Matrix3d RotationAt(const MapFrame& frame, const Eigen::Vector3d& x) {
  constexpr double kStep_m = 10.0;
  Eigen::Matrix3d jacobian;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = kStep_m * Eigen::Vector3d::Unit(axis);
    jacobian.col(axis) = (frame.MapFromEnu(x + step) - frame.MapFromEnu(x - step)) / (2.0 * kStep_m);
  }
  const Eigen::Vector3d up = jacobian.row(2).transpose().normalized();
  const Eigen::Vector3d easting = jacobian.row(0).transpose();
  const Eigen::Vector3d east = (easting - easting.dot(up) * up).normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = east.transpose();
  rotation.row(1) = up.cross(east).transpose();
  rotation.row(2) = up.transpose();
  return rotation;
}

}  // namespace

MapFrame::MapFrame(const scene::SceneInfo& info, geo::Vertical vertical) : origin_(info.origin), heights_(info, vertical) {
  if (!info.georeferenced) return;
  frame_.emplace(info.origin);
  zone_ = geo::UtmZoneOf(info.origin);
  Eigen::Vector3d middle = 0.5 * (info.min_enu + info.max_enu);
  if (!middle.allFinite()) middle.setZero();
  offset_.head<2>() = (MapFromEnu(middle).head<2>() / kOffsetStep_m).array().floor() * kOffsetStep_m;
  map_from_enu_ = RotationAt(*this, middle);
}

Eigen::Vector3d MapFrame::MapFromEnu(const Eigen::Vector3d& x_in_enu) const {
  if (!frame_) return x_in_enu;
  const geo::Geodetic position = frame_->GeodeticFromEnu(x_in_enu);
  const Eigen::Vector2d plane = geo::UtmFromGeodetic(position, zone_);
  return {plane.x(), plane.y(), heights_.FromSurvey(position)};
}

Eigen::Vector3d MapFrame::EnuFromMap(const Eigen::Vector3d& x_in_map) const {
  if (!frame_) return x_in_map;
  geo::Geodetic place = geo::GeodeticFromUtm(x_in_map.head<2>(), x_in_map.z(), zone_);
  place.height_m = heights_.ToSurvey(place);
  return frame_->EnuFromGeodetic(place);
}

Eigen::Vector3f MapFrame::MapDirection(const Eigen::Vector3f& direction_enu) const {
  return (map_from_enu_ * direction_enu.cast<double>()).normalized().cast<float>();
}

std::string MapFrame::CrsName() const {
  return frame_ ? "EPSG:" + std::to_string(zone_.Epsg()) : "local frame, metres";
}

std::string MapFrame::VerticalName() const {
  return heights_.Name();
}

}  // namespace skyquilt::surface
