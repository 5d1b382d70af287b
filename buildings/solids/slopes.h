// The planes of a part's roof; the roof is the lowest of them everywhere, within its rectangle.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/building.h"
#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {

struct Slope {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double offset = 0.0;  // z = slope . uv + offset

  double HeightAt(const Eigen::Vector2d& uv) const { return slope.dot(uv) + offset; }
};
// One of flat roofs, two of gables, four of hips.
std::vector<Slope> SlopesOf(const Shape& shape, const Part& part);
// The part of a convex polygon where normal . uv <= limit.
Ring Clipped(const Ring& convex, const Eigen::Vector2d& normal, double limit);

}  // namespace skyquilt::buildings
