// The gradient of a step's loss by the rays themselves, from which poses of photos are refined (worker/poses/pose_learner.h).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace skyquilt::worker {

// Derivatives of the batch's mean loss by a ray's origin, metres, and direction, ENU. The direction's are those of its three components as if they
// were free; only their part across the direction means a turn.
struct RayGradient {
  Eigen::Vector3d by_origin = Eigen::Vector3d::Zero(), by_direction = Eigen::Vector3d::Zero();
};

struct RayGradients {
  std::vector<float> level_shares;  // in: per part of the encoding, the share of its slopes that counts, 0 to 1
  std::vector<RayGradient> rays;    // out: per ray of the batch
};

}  // namespace skyquilt::worker
