// The bounds of a block, the part of the survey in which one field is trained: a box with a margin around it. Partition, training, scene files,
// reports and evaluation all use this type for a block's place.
#pragma once

#include <Eigen/Core>

namespace skyquilt::geo {

// Survey ENU (x east, y north, z up), metres.
struct BlockBox {
  // Opposite corners of the core box. Core boxes of neighbouring blocks touch at their faces but do not overlap; z goes from below the ground to
  // above the highest roof.
  Eigen::Vector3d min_enu = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_enu = Eigen::Vector3d::Zero();
  // Width of the margin on each horizontal side. The field is trained there too, so that neighbours overlap and can be blended. None above and below.
  double margin_m = 0.0;

  // Opposite corners of the box with its margin.
  Eigen::Vector3d TrainMin() const { return min_enu - Eigen::Vector3d(margin_m, margin_m, 0.0); }
  Eigen::Vector3d TrainMax() const { return max_enu + Eigen::Vector3d(margin_m, margin_m, 0.0); }
};

}  // namespace skyquilt::geo
