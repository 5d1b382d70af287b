// Options of section [partition] of the configuration: how the survey area is divided into blocks.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::partition {

// Neighbouring blocks are blended where they overlap. Each side of a block reaches over by this fraction of its shorter side: the blend needs width,
// and every block's training pays for its margin.
constexpr double kMarginFraction = 0.06;
constexpr double kMinMargin_m = 2.0;  // smallest overlap, for small blocks; never more than a quarter of the side
// Free space below the lowest ground and above the highest roof that sparse points show, which miss the very lowest and highest parts. Clamped to 8
// to 40 GSD, so that it fits any scale.
constexpr double kFreeHeight_m = 1.5;

struct PartitionOptions {
  std::string blocks = "auto";    // "auto", "RxC" (rows x columns) or "size:<metres>"
  std::vector<double> altitudes;  // flying height, metres above ground, one per block, row-major from the south-west; empty: from the photos
  std::string area = "covered";   // "covered": ground that min_views training photos see well; "points": bounds of the sparse points
  int min_views = 2;              // training photos that must see a piece of ground for it to count as covered
  std::string heights = "block";  // "block": each box fits its own points; "survey": all boxes have the height range of the whole survey
  double headroom = 0.25;         // fraction of the flying height added on top of blocks with gaps in the sparse points, such as under trees
  double voxel_per_gsd = 1.5;     // finest voxel as a multiple of the ground sampling distance
  int min_log2_table_size = 14;   // limits of log2 of the entries of a hash table
  int max_log2_table_size = 17;
  double voxels_per_entry = 4.0;      // surface voxels per table entry when a table's size is chosen
  double max_voxels_per_entry = 4.0;  // the same when blocks = "auto" chooses the number of blocks

  static std::vector<config::Field<PartitionOptions>> Fields();
  static std::vector<config::FixedOption> Fixed();
  // Throws base::UsageError that names the option, its value and the rule it breaks.
  void Check() const;
};

}  // namespace skyquilt::partition
