// The distance that a way keeps from what is solid. A piece of the way is judged by its middle: all of it lies within half its length of there. What
// cannot be told for a long piece is told for its halves, so nothing is missed between samples. As web/src/tour/clearance.ts.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "tour/ways/heights.h"
#include "tour/ways/plan_line.h"

namespace skyquilt::tour {

// Kept from everything solid.
constexpr double kWayClearance_m = 1.0;

// A piece of the way in plan with the lowest z that is safe on all of it; Heights::kNothing: every z is.
struct Barrier {
  double from_m = 0.0, to_m = 0.0, z = 0.0;
};

// Barriers along the whole line. Where they are below base_z, the height of a way that needs no detour, they may be rough.
std::vector<Barrier> BarriersAlong(const PlanLine& line, const Heights& heights, const std::function<double(double length_m)>& base_z);

// Whether a piece of the way, straight in (length, z), is nowhere nearer than the clearance. False also where this cannot be told.
bool KeepsClear(const PlanLine& line, const Heights& heights, const Eigen::Vector2d& from, const Eigen::Vector2d& to);

}  // namespace skyquilt::tour
