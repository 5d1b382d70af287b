// Intersects a ray with an axis-aligned box (slab method, Kay and Kajiya 1986). The result is never NaN: rays along a face count as inside, direction
// components may be zero and boxes infinite.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <utility>

namespace skyquilt::geo {

// A part of a ray: points origin + t * direction with t_near <= t <= t_far. t is in metres when the direction has length 1.
struct Interval {
  double t_near = 0.0;
  double t_far = 0.0;
  bool Empty() const { return !(t_far > t_near); }
};

namespace internal {

// The interval with t >= 0 inside all three slabs. t_far < t_near when the ray misses the box, t_far = t_near when it only touches it.
inline Interval SlabInterval(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Vector3d& min,
                             const Eigen::Vector3d& max) {
  constexpr Interval kNowhere = {0.0, -1.0};
  double t_near = 0.0;
  double t_far = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    // Dividing by a zero component would give 0 / 0 for rays along a face.
    if (direction[axis] == 0.0) {
      if (!(origin[axis] >= min[axis] && origin[axis] <= max[axis])) return kNowhere;
      continue;
    }
    double t0 = (min[axis] - origin[axis]) / direction[axis];
    double t1 = (max[axis] - origin[axis]) / direction[axis];
    if (t0 > t1) std::swap(t0, t1);
    t_near = std::max(t_near, t0);
    t_far = std::min(t_far, t1);
  }
  return {t_near, t_far};
}

}  // namespace internal

// The interval inside the box, for sampling along the ray; {0, 0} when the ray misses the box or only touches it.
inline Interval RayBox(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  const Interval inside = internal::SlabInterval(origin, direction, min, max);
  return inside.Empty() ? Interval{} : inside;
}

// Whether the ray (t >= 0) hits the box, for visibility tests: touching an edge or a corner is enough, and the box may be flat.
// False when anything is NaN, and for rays that are not finite.
inline bool RayHitsBox(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  if (!origin.allFinite() || !direction.allFinite() || min.hasNaN() || max.hasNaN()) return false;
  const Interval inside = internal::SlabInterval(origin, direction, min, max);
  return inside.t_near <= inside.t_far;
}

}  // namespace skyquilt::geo
