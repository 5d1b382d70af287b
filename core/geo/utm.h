// UTM coordinates, the projected frame of orthophotos and DSMs; UPS beyond 84 N / 80 S.
#pragma once

#include <Eigen/Core>
#include <string>

#include "core/geo/geodetic.h"

namespace skyquilt::geo {

struct UtmZone {
  int zone = 0;  // 1..60; 0 = UPS (polar)
  bool north = true;

  int Epsg() const;          // 326zz / 327zz; 32661 / 32761 for UPS
  std::string Name() const;  // "UTM 15N", "UPS N"
};

// The standard zone, with the exceptions for Norway and Svalbard. Throws std::invalid_argument for an invalid position.
UtmZone UtmZoneOf(const Geodetic& position);
// Easting and northing in metres in the given zone; the position may be outside the zone or on the other hemisphere.
Eigen::Vector2d UtmFromGeodetic(const Geodetic& position, const UtmZone& zone);
Geodetic GeodeticFromUtm(const Eigen::Vector2d& easting_northing, double height_m, const UtmZone& zone);

}  // namespace skyquilt::geo
