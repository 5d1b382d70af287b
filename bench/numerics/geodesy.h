// Reference positions for numerical checks, in long double from closed formulas and without code of the pipeline. Also the error of naive pipelines
// that keep coordinates in single precision, for comparison.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"

namespace skyquilt::bench {

using Vector3L = Eigen::Matrix<long double, 3, 1>;

// Earth-centred position on the WGS84 ellipsoid, metres.
Vector3L EcefOf(const geo::Geodetic& position);
double DistanceMetres(const geo::Geodetic& a, const geo::Geodetic& b);

enum class NaiveFrame { kDegrees, kEcef, kUtm, kEnu };
const std::vector<NaiveFrame>& NaiveFrames();
std::string NaiveName(NaiveFrame frame);
// How far a position moves when its coordinates in this frame are rounded to single precision. UTM zone and ENU tangent plane are those of the
// origin.
double NaiveErrorMetres(NaiveFrame frame, const geo::Geodetic& origin, const geo::Geodetic& position);

}  // namespace skyquilt::bench
