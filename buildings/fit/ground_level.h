// Height of the ground under a building from the points around it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/building.h"
#include "buildings/fit/fit_points.h"

namespace skyquilt::buildings {

// Of the plane through the points at the middle of the footprint, with its standard deviation; Measure::value is unknown with fewer than 10 points.
Measure GroundLevel(const std::vector<FitPoint>& points, const Eigen::Vector2d& middle, double gsd_m, double spacing_m);

}  // namespace skyquilt::buildings
