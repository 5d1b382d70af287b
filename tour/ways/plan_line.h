// The way between two poses as it looks from above: a polyline with its length as the parameter. As web/src/tour/plan_line.ts.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace skyquilt::tour {

struct PlanLine {
  std::vector<Eigen::Vector2d> points;
  std::vector<double> lengths_m;  // from the beginning to each point; never falls

  double Length() const { return lengths_m.back(); }
  // The place at this length; the ends beyond them.
  Eigen::Vector2d At(double length_m) const;
};

PlanLine StraightLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
// Around `about` the shorter way, counter-clockwise when both are as short; the distance changes evenly with the angle.
PlanLine OrbitLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& about);

}  // namespace skyquilt::tour
