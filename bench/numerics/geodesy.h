// Positions in long double, by the closed formula and nothing of ours: what the pipeline's positions are compared with. And the single-precision
// pipelines that programs are written with when nobody thinks of it.
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
// How far a place moves when its coordinates in that frame (UTM's zone and ENU's tangent plane are the origin's) are kept in single precision.
double NaiveErrorMetres(NaiveFrame frame, const geo::Geodetic& origin, const geo::Geodetic& position);

}  // namespace skyquilt::bench
