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
// middle half of all points within one rectangle's size around. Where a tenth of the rectangle or more has no points (foliage and water have
// no features to match) the top may be far above them: it is raised by options.headroom * altitude_m. Nothing when no point lies inside.
std::optional<std::pair<double, double>> VerticalRange(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low,
                                                       const Eigen::Vector2d& high, double gsd_m, double altitude_m,
                                                       const PartitionOptions& options);

}  // namespace skyquilt::partition
