#include "core/geo/ecef.h"

#include <GeographicLib/Geocentric.hpp>
#include <stdexcept>
#include <vector>

namespace skyquilt::geo {
namespace {

void RequireValid(const Geodetic& position) {
  if (!IsValid(position)) throw std::invalid_argument("earth-centred coordinates need finite coordinates and a latitude in [-90, 90]");
}

}  // namespace

Eigen::Vector3d EcefFromGeodetic(const Geodetic& position) {
  RequireValid(position);
  Eigen::Vector3d x;
  GeographicLib::Geocentric::WGS84().Forward(position.latitude_deg, WrapLongitudeDeg(position.longitude_deg), position.height_m, x.x(), x.y(), x.z());
  return x;
}

Geodetic GeodeticFromEcef(const Eigen::Vector3d& x_in_ecef) {
  if (!x_in_ecef.allFinite()) throw std::invalid_argument("earth-centred coordinates must be finite");
  Geodetic position;
  GeographicLib::Geocentric::WGS84().Reverse(x_in_ecef.x(), x_in_ecef.y(), x_in_ecef.z(), position.latitude_deg, position.longitude_deg,
                                             position.height_m);
  position.longitude_deg = WrapLongitudeDeg(position.longitude_deg);
  return position;
}

Eigen::Matrix4d EcefFromEnu(const Geodetic& origin) {
  RequireValid(origin);
  std::vector<double> rotation(9);  // row-major
  Eigen::Vector3d x;
  GeographicLib::Geocentric::WGS84().Forward(origin.latitude_deg, WrapLongitudeDeg(origin.longitude_deg), origin.height_m, x.x(), x.y(), x.z(),
                                             rotation);
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) transform(row, column) = rotation[static_cast<size_t>(3 * row + column)];
    transform(row, 3) = x[row];
  }
  return transform;
}

}  // namespace skyquilt::geo
