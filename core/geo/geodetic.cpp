#include "core/geo/geodetic.h"

#include <cmath>

namespace skyquilt::geo {

bool IsValid(const Geodetic& position) {
  return std::isfinite(position.latitude_deg) && std::isfinite(position.longitude_deg) && std::isfinite(position.height_m) &&
         std::abs(position.latitude_deg) <= 90.0;
}

double WrapLongitudeDeg(double longitude_deg) {
  // std::remainder is exact and its result is in [-180, 180].
  const double wrapped = std::remainder(longitude_deg, 360.0);
  return wrapped == 180.0 ? -180.0 : wrapped;
}

}  // namespace skyquilt::geo
