// Blends overlapping blocks so that no seam shows at their borders: the weight of a block is 1 inside its core box and falls by a smoothstep ramp
// across [face - margin, face + margin]. The ramps of two neighbours with the same margin sum to 1. Where the weights sum to more than 1, the caller
// divides by their sum.
#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace skyquilt::render {

// distance_inside: metres from the face, positive inside the core box. margin 0 gives a step.
inline double SmoothRamp(double distance_inside, double margin) {
  if (margin <= 0.0) return distance_inside >= 0.0 ? 1.0 : 0.0;
  const double s = std::clamp(0.5 + 0.5 * distance_inside / margin, 0.0, 1.0);
  return s * s * (3.0 - 2.0 * s);
}

// Weight of a block at (x, y), ENU metres. It does not depend on the height.
inline double BlockRamp(const Eigen::Vector3d& core_min, const Eigen::Vector3d& core_max, double margin, double x, double y) {
  return SmoothRamp(x - core_min.x(), margin) * SmoothRamp(core_max.x() - x, margin) * SmoothRamp(y - core_min.y(), margin) *
         SmoothRamp(core_max.y() - y, margin);
}

}  // namespace skyquilt::render
