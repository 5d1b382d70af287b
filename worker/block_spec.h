// What the trainer needs to know of a block; filled by the coordinator from partition::Block.
#pragma once

#include <string>
#include <vector>

#include "core/geo/block_box.h"

namespace skyquilt::worker {

struct BlockSpec {
  std::string name;
  geo::BlockBox box;
  double finest_voxel_m = 0.1;  // finest level of the encoding
  int log2_table_size = 17;
  std::vector<int> photos;  // indices into Survey::photos that see it
};

}  // namespace skyquilt::worker
