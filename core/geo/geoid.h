// EGM96, the geoid that maps call mean sea level and most GPS receivers use for their heights.
// Source: NGA's 15' grid egm96_15.gtx, interpolated bilinearly by PROJ (Debian: proj-data); within a few centimetres of the model itself.
#pragma once

#include <vector>

#include "core/geo/geodetic.h"

namespace skyquilt::geo {

// Height of the geoid above the WGS84 ellipsoid there, metres, -107 to 86: an ellipsoidal height less this is a height above EGM96.
// Throws base::InputError when PROJ does not find the grid, std::invalid_argument when the position is not valid. May be called from any thread.
double Egm96Undulation(double latitude_deg, double longitude_deg);

// The geoid of EGM96 around a survey, fast enough for every point of a cloud.
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
