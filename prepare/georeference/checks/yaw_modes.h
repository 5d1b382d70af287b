// The dominant horizontal directions of a place from many straight horizontal lines.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/survey/directions.h"

namespace skyquilt::prepare::georeference {

// A horizontal straight line, such as a roof edge or a kerb.
struct HorizontalLine {
  double yaw_deg = 0.0;   // counter-clockwise from east; any number of degrees
  double length_m = 0.0;  // > 0
  Eigen::Vector2d place_enu = Eigen::Vector2d::Zero();
};

// Modes of the lines' directions on the circle of 90 degrees by mean shift with a bandwidth of 2 degrees, weighted by length (shortened, so that no
// single line decides). Kept are those that clearly stand out from lines in any direction. `photos` is only recorded.
survey::DominantDirections FindDirections(const std::vector<HorizontalLine>& lines, int photos);

}  // namespace skyquilt::prepare::georeference
