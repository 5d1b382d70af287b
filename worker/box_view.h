// What the trainer needs to know of a block; filled by the coordinator from partition::Block.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace skyquilt::worker {

struct BoxView {
  std::string name;
  Eigen::Vector3d min_enu = Eigen::Vector3d::Zero();  // core box, metres
  Eigen::Vector3d max_enu = Eigen::Vector3d::Zero();
  double margin_m = 0.0;        // horizontal overlap on each side
  double finest_voxel_m = 0.1;  // finest level of the encoding
  int log2_table_size = 17;
  std::vector<int> photos;  // indices into Survey::photos that see it
};

}  // namespace skyquilt::worker
