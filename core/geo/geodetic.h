// WGS84 geodetic coordinates. Degrees; height in metres above the ellipsoid.
#pragma once

namespace skyquilt::geo {

struct Geodetic {
  double latitude_deg = 0.0;   // [-90, 90]
  double longitude_deg = 0.0;  // [-180, 180)
  double height_m = 0.0;       // ellipsoidal
};

// True when all three values are finite and the latitude is in [-90, 90].
bool IsValid(const Geodetic& position);
// Wraps to [-180, 180).
double WrapLongitudeDeg(double longitude_deg);

}  // namespace skyquilt::geo
