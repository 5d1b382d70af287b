// Which roof fits the points of a rectangle: flat, gable along u or v, or hip, by the Bayesian information criterion on a robust likelihood.
#pragma once

#include <Eigen/Core>
#include <span>

#include "buildings/building.h"

namespace skyquilt::buildings {

struct RoofFit {
  RoofKind roof = RoofKind::kFlat;
  bool along_u = true;
  double eave_z = 0.0, ridge_z = 0.0;
  double bic = 0.0;           // lower is better
  double share_within = 0.0;  // of the points, within tolerance_m of the roof
};
// points: u, v, z. min_uv, max_uv: walls of the rectangle. overhang_m: roofs of points outside the walls continue. tolerance_m: 2 GSD. n_eff: points
// that count as independent. Points on parapets, rooftop boxes and chimneys are outliers (Cauchy loss). A pitched roof needs a pitch of 5.7 degrees.
RoofFit ChooseRoof(std::span<const Eigen::Vector3d> points, const Eigen::Vector2d& min_uv, const Eigen::Vector2d& max_uv, double tolerance_m,
                   double n_eff);

}  // namespace skyquilt::buildings
