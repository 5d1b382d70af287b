// Partition-of-unity weights of overlapping blocks: 1 inside a core box, a smoothstep ramp across [face - margin, face + margin].
// Ramps of two neighbours with the same margin sum to one; where more than one is left over, the caller divides by the sum.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace skyquilt::render {

inline double SmoothRamp(double distance_inside, double margin) {
  if (margin <= 0.0) return distance_inside >= 0.0 ? 1.0 : 0.0;
  const double s = std::clamp(0.5 + 0.5 * distance_inside / margin, 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

// Horizontal weight of a block at (x, y), ENU metres; the vertical range does not blend.
inline double BlockRamp(const Eigen::Vector3d& core_min, const Eigen::Vector3d& core_max, double margin, double x, double y) {
  return SmoothRamp(x - core_min.x(), margin) * SmoothRamp(core_max.x() - x, margin) * SmoothRamp(y - core_min.y(), margin) *
         SmoothRamp(core_max.y() - y, margin);
}

}  // namespace skyquilt::render
