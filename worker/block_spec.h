// Where a block is and how finely it is modelled, as the trainer needs it. The coordinator fills it from partition::Block, so that worker does not
// depend on partition.
#pragma once

#include <string>
#include <vector>

#include "core/geo/block_box.h"

namespace skyquilt::worker {

struct BlockSpec {
  std::string name;
  geo::BlockBox box;
  double finest_voxel_m = 0.1;  // cell size of the finest level of the encoding
  double gsd_m = 0.1;           // ground sampling distance of the photos as trained
  int log2_table_size = 17;     // log2 of the entries per level of the hash grid
  std::vector<int> photos;      // photos that see the block, as indices into Survey::photos
};

}  // namespace skyquilt::worker
