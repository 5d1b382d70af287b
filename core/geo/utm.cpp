#include "core/geo/utm.h"

#include <GeographicLib/PolarStereographic.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <stdexcept>

namespace skyquilt::geo {
namespace {

// GeographicLib's UTMUPS refuses points far outside a zone and changes the hemisphere by itself. A map that crosses a border needs one continuous
// frame, so we use the underlying projections with the false eastings and northings of NGA.SIG.0012.
constexpr double kUtmFalseEasting_m = 500e3;
constexpr double kUtmFalseNorthingSouth_m = 10000e3;
constexpr double kUpsFalseOrigin_m = 2000e3;

double CentralMeridianDeg(const UtmZone& zone) {
  return 6.0 * zone.zone - 183.0;
}

Eigen::Vector2d FalseOrigin(const UtmZone& zone) {
  if (zone.zone == 0) return {kUpsFalseOrigin_m, kUpsFalseOrigin_m};
  return {kUtmFalseEasting_m, zone.north ? 0.0 : kUtmFalseNorthingSouth_m};
}

}  // namespace

int UtmZone::Epsg() const {
  if (zone == 0) return north ? 32661 : 32761;
  return (north ? 32600 : 32700) + zone;
}

std::string UtmZone::Name() const {
  if (zone == 0) return north ? "UPS N" : "UPS S";
  return "UTM " + std::to_string(zone) + (north ? "N" : "S");
}

UtmZone UtmZoneOf(const Geodetic& position) {
  if (!IsValid(position)) throw std::invalid_argument("a UTM zone needs finite coordinates and a latitude in [-90, 90]");
  return {GeographicLib::UTMUPS::StandardZone(position.latitude_deg, WrapLongitudeDeg(position.longitude_deg)), position.latitude_deg >= 0.0};
}

Eigen::Vector2d UtmFromGeodetic(const Geodetic& position, const UtmZone& zone) {
  double x = 0.0;
  double y = 0.0;
  if (zone.zone == 0) {
    GeographicLib::PolarStereographic::UPS().Forward(zone.north, position.latitude_deg, position.longitude_deg, x, y);
  } else {
    GeographicLib::TransverseMercator::UTM().Forward(CentralMeridianDeg(zone), position.latitude_deg, position.longitude_deg, x, y);
  }
  return Eigen::Vector2d(x, y) + FalseOrigin(zone);
}

Geodetic GeodeticFromUtm(const Eigen::Vector2d& easting_northing, double height_m, const UtmZone& zone) {
  const Eigen::Vector2d plane = easting_northing - FalseOrigin(zone);
  Geodetic position;
  position.height_m = height_m;
  if (zone.zone == 0) {
    GeographicLib::PolarStereographic::UPS().Reverse(zone.north, plane.x(), plane.y(), position.latitude_deg, position.longitude_deg);
  } else {
    GeographicLib::TransverseMercator::UTM().Reverse(CentralMeridianDeg(zone), plane.x(), plane.y(), position.latitude_deg, position.longitude_deg);
  }
  position.longitude_deg = WrapLongitudeDeg(position.longitude_deg);
  return position;
}

}  // namespace skyquilt::geo
