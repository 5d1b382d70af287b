// Where a block stands: the box on the ground in which one field is trained. Everything that is placed like a block (as it is cut, trained,
// stored, shown or scored) is one of these or holds one, and hands it on as one value.
#pragma once

#include <Eigen/Core>

namespace skyquilt::geo {

// Survey ENU (x east, y north, z up), metres.
struct BlockBox {
  // Opposite corners of the core box, the part that the block alone answers for. Core boxes of neighbours share faces without overlapping;
  // z: from below the ground to above the highest roof.
  Eigen::Vector3d min_enu = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_enu = Eigen::Vector3d::Zero();
  // Trained beyond the core box on each horizontal side, so that neighbours overlap and can be blended; up and down there is none.
  double margin_m = 0.0;

  // Corners of the box with its margin.
  Eigen::Vector3d TrainMin() const { return min_enu - Eigen::Vector3d(margin_m, margin_m, 0.0); }
  Eigen::Vector3d TrainMax() const { return max_enu + Eigen::Vector3d(margin_m, margin_m, 0.0); }
};

}  // namespace skyquilt::geo
