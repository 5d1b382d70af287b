// How the survey area is cut into blocks: [partition] in the configuration.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::partition {

struct PartitionOptions {
  std::string blocks = "auto";    // "auto", "RxC" (rows x columns) or "size:<metres>"
  std::vector<double> altitudes;  // metres above ground, one per block, row-major from the south-west; empty: from the flight
  std::string area = "covered";   // "covered": ground that min_views training photos see well; "points": bounds of the sparse points
  int min_views = 2;              // training photos that must see a place for it to count as covered
  double margin_fraction = 0.06;  // overlap on each side as a share of the shorter block side, [0, 0.25]
  double min_margin_m = 2.0;      // overlap at least this wide, but never above a quarter of the side
  double z_margin_below_m = 1.5;  // air under the lowest ground; held between 8 and 40 GSD so that it fits any scale
  double z_margin_above_m = 1.5;  // air over the highest roof; likewise
  std::string heights = "block";  // "block": a box is as high as what stands in it; "survey": all share the lowest ground and the highest roof
  double headroom = 0.25;         // share of the flying height added above where sparse points leave gaps, as over canopy
  double voxel_per_gsd = 1.5;     // finest voxel as a multiple of the ground sampling distance
  int min_log2_table_size = 14;
  int max_log2_table_size = 17;
  double voxels_per_entry = 4.0;
  double max_voxels_per_entry = 4.0;
  double parameter_budget = 0.0;  // hash entries (of the finest level) over the whole survey that "auto" may use; 0: no limit

  static std::vector<config::Field<PartitionOptions>> Fields();
  // Throws base::UsageError naming the option, its value and the rule it breaks.
  void Check() const;
};

}  // namespace skyquilt::partition
