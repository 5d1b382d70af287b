// Earth-centred, Earth-fixed coordinates of WGS84 (EPSG:4978), metres: x through the equator at longitude 0, y at 90 E, z through the north pole.
// Source: GeographicLib::Geocentric (Karney), the same that EnuFrame uses; valid anywhere, including the poles and the date line.
#pragma once

#include <Eigen/Core>

#include "core/geo/geodetic.h"

namespace skyquilt::geo {

// Throws std::invalid_argument if the position is not valid, as do the functions below.
Eigen::Vector3d EcefFromGeodetic(const Geodetic& position);
// The inverse, for any finite position; the centre of the Earth becomes the north pole.
Geodetic GeodeticFromEcef(const Eigen::Vector3d& x_in_ecef);
// The rigid transform (homogeneous, acts on columns) from the frame that EnuFrame has at this origin.
Eigen::Matrix4d EcefFromEnu(const Geodetic& origin);

}  // namespace skyquilt::geo
