// How many of the residuals on a surface are independent.
#pragma once

#include <Eigen/Core>
#include <span>

namespace skyquilt::buildings {

// The correlation area of residuals at these places, m2: the integral over the plane of their correlation, from the variogram up to the lag at which
// it has fallen to a tenth. At least one point's share of the area, at most half the area.
double CorrelationArea(std::span<const Eigen::Vector2d> at, std::span<const double> residuals, double area_m2);

}  // namespace skyquilt::buildings
