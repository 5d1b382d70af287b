// Least-squares fit of a shape to the points of roof, walls and ground (Ceres), with the covariance of its parameters.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/building.h"
#include "buildings/candidates/find_candidates.h"
#include "buildings/points/surface_points.h"
#include "core/geo/place_accuracy.h"

namespace skyquilt::buildings {

struct FitOptions {
  double gsd_m = 0.1;
  double default_overhang_m = 0.0;  // of pitched roofs without seen walls
  double overhang_sigma_m = 0.3;    // of that assumption
  geo::PlaceAccuracy accuracy;      // of the survey; unknown parts do not count
};

// Parameters in the order of the covariance: yaw, u lines, v lines, eave and ridge of each part (flat and other: ridge follows eave and has no row),
// ground. Units: radians, metres.
struct FittedShape {
  Shape shape;
  Eigen::MatrixXd covariance;        // s^2 (J^T J)^-1 n / n_eff, n_eff from the residuals' correlation length
  double overhang_m = 0.0;           // median distance of the roof's edge from seen walls; NaN: no wall was seen
  std::vector<bool> u_seen, v_seen;  // whether a line was fitted to wall points; else to the roof's edge less the overhang
  double share_within = 0.0, residual_m = 0.0;
  int64_t roof_points = 0, wall_points = 0;
  bool converged = true;
};
// Roof points: distance from the plane of the part that is highest there; wall points: distance from the wall line of their normal's side; rims of
// roofs: distance from that line and the overhang, which is a parameter common to the pitched parts; ground: the plane through the ring's points at
// the middle of the footprint. Cauchy losses. Too few points: the guess, not converged. Same input, same result.
FittedShape FitShape(const Shape& guess, const Candidate& candidate, const PointCloud& cloud, const FitOptions& options);

// Measures of the shape with their standard deviations: propagated from the covariance by differences of each measure with respect to the parameters,
// plus the geo-reference's part (scale for lengths, areas and volumes; tilt for height differences; vertical for ground, eave and ridge; yaw).
Measures MeasureShape(const FittedShape& fitted, const FitOptions& options);
// Measures::wall_seen: share of the area of outer walls (in pieces of 0.5 m) with a steep point seen by at least three views within 2 GSD.
double ShareOfWallSeen(const Shape& shape, const Candidate& candidate, const PointCloud& cloud, double gsd_m);

}  // namespace skyquilt::buildings
