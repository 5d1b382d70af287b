#include "partition/partition_options.h"

#include "core/base/errors.h"
#include "partition/block_grid.h"

namespace skyquilt::partition {
std::vector<config::Field<PartitionOptions>> PartitionOptions::Fields() {
  using config::Range;
  using O = PartitionOptions;
  return {
      {"blocks", &O::blocks, Range(), "auto, RxC (rows x columns, for instance 2x2) or size:<metres>"},
      {"altitudes", &O::altitudes, Range{0.1, 1e5},
       "metres above ground, one per block in row-major order from the south-west; empty: from the flight"},
      {"area", &O::area, Range::OneOf({"covered", "points"}),
       "what is cut into blocks. covered: ground that min_views training photos see well; points: bounds of the sparse points"},
      {"min_views", &O::min_views, Range{1, 100}, "training photos that must see a place for it to count as covered"},
      {"margin_fraction", &O::margin_fraction, Range{0, 0.25}, "overlap on each side of a block as a share of its shorter side"},
      {"min_margin_m", &O::min_margin_m, Range{0, 1e5}, "overlap at least this wide, metres; never above a quarter of the side"},
      {"z_margin_below_m", &O::z_margin_below_m, Range{0, 1e5}, "metres of box below the lowest ground; held between 8 and 40 ground pixels"},
      {"z_margin_above_m", &O::z_margin_above_m, Range{0, 1e5}, "metres of box above the highest roof; held between 8 and 40 ground pixels"},
      {"heights", &O::heights, Range::OneOf({"block", "survey"}),
       "block: every box is as high as what stands in it; survey: all are as high as the highest (floaters gather above low roofs)"},
      {"headroom", &O::headroom, Range{0, 1},
       "share of the flying height added to the top of blocks of which three tenths or more have no sparse points, as under canopy"},
      {"voxel_per_gsd", &O::voxel_per_gsd, Range{0.1, 100}, "finest voxel as a multiple of the ground sampling distance"},
      {"min_log2_table_size", &O::min_log2_table_size, Range{1, 24}, "smallest hash table of a level, log2 of its entries"},
      {"max_log2_table_size", &O::max_log2_table_size, Range{1, 24}, "largest hash table of a level, log2 of its entries"},
      {"voxels_per_entry", &O::voxels_per_entry, Range{0.1, 1000},
       "finest voxels of surface that share an entry of a block's tables, where the largest table allows: more means smaller tables"},
      {"max_voxels_per_entry", &O::max_voxels_per_entry, Range{0.1, 1000},
       "with blocks = auto: blocks are cut until no more finest voxels of surface than these share an entry of the largest table"},
      {"parameter_budget", &O::parameter_budget, Range{0, 1e15}, "entries of the finest level over all blocks that auto may use; 0: no limit"},
  };
}

void PartitionOptions::Check() const {
  config::CheckRanges("partition", *this);
  ParseBlockRequest(blocks);
  if (min_log2_table_size > max_log2_table_size) {
    throw base::UsageError("partition.min_log2_table_size = " + std::to_string(min_log2_table_size) +
                           " is not allowed: it must not exceed max_log2_table_size = " + std::to_string(max_log2_table_size));
  }
}

}  // namespace skyquilt::partition
