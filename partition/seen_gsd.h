// Ground sampling distance by what photos saw: of a sparse point, the median of distance over focal length in the training photos that observed it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/survey/survey.h"
#include "partition/block_grid.h"

namespace skyquilt::partition {

struct SeenPoint {
  Eigen::Vector2d x_enu = Eigen::Vector2d::Zero();  // its place on the map, metres
  double gsd_m = 0.0;                               // metres per pixel there at the training width, > 0
};

// The sparse points that at least two training photos observed; none where no tracks are known. image_width: training width in pixels, 0 = full size.
std::vector<SeenPoint> SeenPoints(const survey::Survey& survey, int image_width);

// Per cell of the grid the median of its points; NaN where they are fewer than survey::kFewestSeenPoints.
std::vector<double> SeenGsds(const std::vector<SeenPoint>& points, const BlockGrid& grid);

}  // namespace skyquilt::partition
