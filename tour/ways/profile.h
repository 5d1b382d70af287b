// Height along a way: the string that is pulled tight over all barriers, with its corners rounded where that keeps the clearance. As
// web/src/tour/profile.ts.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tour/ways/heights.h"
#include "tour/ways/plan_line.h"

namespace skyquilt::tour {

// Points (length in plan, z) from end to end. over: rises over the highest that is between, also where a lower way is free. heights: null when
// nothing is known to be in the way.
std::vector<Eigen::Vector2d> ProfileAlong(const PlanLine& line, double from_z, double to_z, const Heights* heights, bool over);

}  // namespace skyquilt::tour
