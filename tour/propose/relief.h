// Where the surface has most relief, for surveys without buildings: heaps, slopes, trees, walls.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tour/ways/heights.h"

namespace skyquilt::tour {

struct ReliefPlace {
  Eigen::Vector3d low_enu;  // middle of the window, at its low ground
  double size_m = 0.0;      // side of the window
  double relief_m = 0.0;    // from the low ground to what stands on it
};

// The places with most relief, best first, at least two windows apart from each other and from `taken`. Windows at the border, or with less than half
// of their cells known, do not count: the border of a survey is seen by few photos.
std::vector<ReliefPlace> FindRelief(const Heights& heights, int most, const std::vector<Eigen::Vector2d>& taken);

}  // namespace skyquilt::tour
