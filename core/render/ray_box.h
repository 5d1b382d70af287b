// The stretch of a ray inside an axis-aligned box (slab method, Kay and Kajiya 1986). A miss is an empty stretch, never NaN: rays along a
// face count as inside, zero direction components and infinite boxes are legal.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <utility>

namespace skyquilt::render {

struct Stretch {
  double t_near = 0.0;
  double t_far = 0.0;
  bool Empty() const { return !(t_far > t_near); }
};

inline Stretch RayBox(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  double t_near = 0.0;
  double t_far = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (!(origin[axis] >= min[axis] && origin[axis] <= max[axis])) return {0.0, 0.0};
      continue;
    }
    double t0 = (min[axis] - origin[axis]) / direction[axis];
    double t1 = (max[axis] - origin[axis]) / direction[axis];
    if (t0 > t1) std::swap(t0, t1);
    t_near = std::max(t_near, t0);
    t_far = std::min(t_far, t1);
  }
  if (!(t_far > t_near)) return {0.0, 0.0};
  return {t_near, t_far};
}

}  // namespace skyquilt::render
