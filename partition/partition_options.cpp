#include "partition/partition_options.h"

#include <cmath>

#include "core/base/errors.h"
#include "partition/block_grid.h"

namespace skyquilt::partition {
namespace {

void Require(bool good, const std::string& key, const std::string& value, const std::string& rule) {
  if (!good) throw base::UsageError("partition." + key + " = " + value + ": " + rule);
}

void RequireRange(const std::string& key, double value, double low, double high) {
  const bool good = std::isfinite(value) && value >= low && value <= high;
  Require(good, key, std::to_string(value), "must lie in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
}

}  // namespace

void PartitionOptions::Visit(config::OptionVisitor& v) {
  v.Field("blocks", blocks, "auto, RxC (rows x columns, for instance 2x2) or size:<metres>");
  v.Field("altitudes", altitudes, "metres above ground, one per block in row-major order from the south-west; empty: from the flight");
  v.Field("area", area, "covered (ground that min_views training photos see well) or points (bounds of the sparse points)");
  v.Field("min_views", min_views, "training photos that must see a place for it to count as covered, 1..100");
  v.Field("margin_fraction", margin_fraction, "overlap on each side of a block as a share of its shorter side, 0..0.25");
  v.Field("min_margin_m", min_margin_m, "overlap at least this wide, metres; never above a quarter of the side");
  v.Field("z_margin_below_m", z_margin_below_m, "metres of box below the lowest ground; held between 8 and 40 ground pixels");
  v.Field("z_margin_above_m", z_margin_above_m, "metres of box above the highest roof; held between 8 and 40 ground pixels");
  v.Field("heights", heights,
          "block: every box is as high as what stands in it; survey: all are as high as the highest (floaters gather above low roofs)");
  v.Field("headroom", headroom,
          "share of the flying height added to the top of blocks of which three tenths or more have no sparse points, as under canopy; 0..1");
  v.Field("voxel_per_gsd", voxel_per_gsd, "finest voxel as a multiple of the ground sampling distance, 0.1..100");
  v.Field("min_log2_table_size", min_log2_table_size, "smallest hash table of a level, log2 of its entries, 1..24");
  v.Field("max_log2_table_size", max_log2_table_size, "largest hash table of a level, log2 of its entries, 1..24");
  v.Field("voxels_per_entry", voxels_per_entry,
          "finest voxels of surface that share an entry of a block's tables, where the largest table allows: more means smaller tables; 0.1..1000");
  v.Field("max_voxels_per_entry", max_voxels_per_entry,
          "with blocks = auto: blocks are cut until no more finest voxels of surface than these share an entry of the largest table; 0.1..1000");
  v.Field("parameter_budget", parameter_budget, "entries of the finest level over all blocks that auto may use; 0: no limit");
}

void PartitionOptions::Check() const {
  ParseBlockRequest(blocks);
  for (size_t i = 0; i < altitudes.size(); ++i) {
    Require(std::isfinite(altitudes[i]) && altitudes[i] > 0.0, "altitudes[" + std::to_string(i) + "]", std::to_string(altitudes[i]),
            "an altitude above ground must be a positive number of metres");
  }
  Require(area == "covered" || area == "points", "area", area, "must be covered or points");
  RequireRange("min_views", min_views, 1, 100);
  RequireRange("margin_fraction", margin_fraction, 0.0, 0.25);
  RequireRange("min_margin_m", min_margin_m, 0.0, 1e5);
  RequireRange("z_margin_below_m", z_margin_below_m, 0.0, 1e5);
  RequireRange("z_margin_above_m", z_margin_above_m, 0.0, 1e5);
  Require(heights == "block" || heights == "survey", "heights", heights, "must be block or survey");
  RequireRange("headroom", headroom, 0.0, 1.0);
  RequireRange("voxel_per_gsd", voxel_per_gsd, 0.1, 100.0);
  RequireRange("min_log2_table_size", min_log2_table_size, 1, 24);
  RequireRange("max_log2_table_size", max_log2_table_size, 1, 24);
  Require(min_log2_table_size <= max_log2_table_size, "min_log2_table_size", std::to_string(min_log2_table_size),
          "must not exceed max_log2_table_size = " + std::to_string(max_log2_table_size));
  RequireRange("voxels_per_entry", voxels_per_entry, 0.1, 1000.0);
  RequireRange("max_voxels_per_entry", max_voxels_per_entry, 0.1, 1000.0);
  Require(std::isfinite(parameter_budget) && parameter_budget >= 0.0, "parameter_budget", std::to_string(parameter_budget), "must be 0 or positive");
}

}  // namespace skyquilt::partition
