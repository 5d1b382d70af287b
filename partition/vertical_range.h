// A block's own height: ground to roof, from the sparse points inside it and nobody else's.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "partition/partition_options.h"

namespace skyquilt::partition {

// Lowest and highest z (metres) of the box over a rectangle: the 0.5 % and 99.8 % percentiles of the points inside, widened by the margins of
// the options, each held between 8 and 40 GSD. Fewer than 50 points are too few for percentiles: their full range is joined with the
// middle half of all points within one rectangle's size around. Nothing when no point lies inside.
std::optional<std::pair<double, double>> VerticalRange(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low,
                                                       const Eigen::Vector2d& high, double gsd_m, const PartitionOptions& options);

// Share without points of the part of a rectangle that lies within the bounds of all points, on a raster whose cells would hold eight points each if
// these were spread evenly: how much of it may hold things without features to match, such as foliage, whose height the points do not tell. 1 when
// there is no such part.
double ShareWithoutPoints(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

}  // namespace skyquilt::partition
