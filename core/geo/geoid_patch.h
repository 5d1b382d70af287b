// The geoid of EGM96 around a survey, fast enough for every point of a cloud.
#pragma once

#include <vector>

#include "core/geo/geodetic.h"

namespace skyquilt::geo {

// Holds the nodes of EGM96's 15' grid around a place and is linear between them in latitude and in longitude, as Egm96Undulation is: both agree to
// rounding. Beyond the nodes it asks Egm96Undulation. Immutable, so it may be used by several threads.
class GeoidPatch {
 public:
  // Nodes for everything within radius_m of the centre. Throws as Egm96Undulation does.
  GeoidPatch(const Geodetic& centre, double radius_m);

  // Height of the geoid above the ellipsoid, metres.
  double At(double latitude_deg, double longitude_deg) const;

 private:
  double middle_longitude_deg_;
  int first_row_ = 0, first_column_ = 0;  // in steps of the grid from -90 and -180 degrees; columns go on beyond the date line
  int rows_ = 0, columns_ = 0;
  std::vector<double> node_m_;  // row-major
};

}  // namespace skyquilt::geo
