// EGM96, the geoid that maps call mean sea level and most GPS receivers use for their heights.
// Source: NGA's 15' grid egm96_15.gtx, interpolated bilinearly by PROJ (Debian: proj-data); within a few centimetres of the model itself.
#pragma once

namespace skyquilt::geo {

// Height of the geoid above the WGS84 ellipsoid there, metres, -107 to 86: an ellipsoidal height less this is a height above EGM96.
// Throws base::InputError when PROJ does not find the grid, std::invalid_argument when the position is not valid. May be called from any thread.
double Egm96Undulation(double latitude_deg, double longitude_deg);

}  // namespace skyquilt::geo
