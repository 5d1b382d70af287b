// Whether a point is inside a ring, by the even-odd rule, for tests.
#pragma once

#include <Eigen/Core>

#include "simulate/rectangle_union.h"

namespace skyquilt::simulate {

inline bool IsInside(const Ring& ring, const Eigen::Vector2d& at) {
  bool inside = false;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if ((a.y() > at.y()) != (b.y() > at.y()) && at.x() < a.x() + (at.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

}  // namespace skyquilt::simulate
