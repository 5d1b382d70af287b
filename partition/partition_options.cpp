#include "partition/partition_options.h"

#include "core/base/errors.h"
#include "partition/block_grid.h"

namespace skyquilt::partition {
std::vector<config::Field<PartitionOptions>> PartitionOptions::Fields() {
  using config::Range;
  using O = PartitionOptions;
  return {
      {"blocks", &O::blocks, Range(),
       "number of blocks: auto (from the survey), RxC (rows x columns, for instance 2x2) or size:<metres> (side of a block)"},
      {"altitudes", &O::altitudes, Range{0.1, 1e5},
       "flying height in metres above ground, one per block in row-major order from the south-west; empty: from the photos"},
      {"area", &O::area, Range::OneOf({"covered", "points"}),
       "ground to divide into blocks. covered: what at least min_views training photos see well; points: bounds of the sparse points"},
      {"min_views", &O::min_views, Range{1, 100}, "training photos that must see a piece of ground for it to count as covered"},
      {"heights", &O::heights, Range::OneOf({"block", "survey"}),
       "block: the height of each box fits its own points; survey: all boxes have the height range of the whole survey (more floaters above low "
       "roofs)"},
      {"headroom", &O::headroom, Range{0, 1},
       "fraction of the flying height added on top of blocks that have no sparse points on 30 % or more of their ground, such as under trees"},
      {"voxel_per_gsd", &O::voxel_per_gsd, Range{0.1, 100}, "finest voxel as a multiple of the ground sampling distance"},
      {"min_log2_table_size", &O::min_log2_table_size, Range{1, 24}, "smallest hash table of a level, log2 of its entries"},
      {"max_log2_table_size", &O::max_log2_table_size, Range{1, 24}, "largest hash table of a level, log2 of its entries"},
      {"voxels_per_entry", &O::voxels_per_entry, Range{0.1, 1000},
       "surface voxels of the finest level per table entry, used to choose a block's table size: more means smaller tables"},
      {"max_voxels_per_entry", &O::max_voxels_per_entry, Range{0.1, 1000},
       "with blocks = auto: use enough blocks that none has more surface voxels of the finest level per entry of the largest table"},
  };
}

std::vector<config::FixedOption> PartitionOptions::Fixed() {
  // parameter_budget was a limit of all table entries; 0: none.
  return {{"margin_fraction", kMarginFraction},
          {"min_margin_m", kMinMargin_m},
          {"z_margin_below_m", kFreeHeight_m},
          {"z_margin_above_m", kFreeHeight_m},
          {"parameter_budget", 0.0}};
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
