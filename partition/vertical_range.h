// Height range of a block's box, from ground to roof, by its own sparse points. A box that fits leaves little room for floaters.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

namespace skyquilt::partition {

// Lowest and highest z (metres) of the box over a rectangle: the 0.5 % and 99.8 % percentiles of the points inside, widened by
// kFreeHeight_m, clamped to 8..40 GSD. With fewer than 50 points inside: their full range, joined with the middle half of the heights of
// all points within one rectangle's size around. Nothing when no point is inside.
std::optional<std::pair<double, double>> VerticalRange(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low,
                                                       const Eigen::Vector2d& high, double gsd_m);

// Share of a rectangle's ground without sparse points, in [0, 1], on a raster with eight points per cell on average; only the part within the bounds
// of all points counts, 1 when there is none. In such gaps there may be things without features to match, such as foliage, of unknown height.
double ShareWithoutSparsePoints(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

}  // namespace skyquilt::partition
