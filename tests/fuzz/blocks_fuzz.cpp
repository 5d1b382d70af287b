// blocks.geojson.
#include <fstream>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "partition/block.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (const bool georeferenced : {true, false}) {
    partition::BlockSet set;
    set.origin = {46.0, 7.0, 400.0};
    set.georeferenced = georeferenced;
    set.accuracy = {.scale_percent = 0.5, .tilt_deg = 0.3, .yaw_deg = 0.2, .horizontal_m = 1.5};
    set.rows = 1;
    set.columns = 2;
    for (int i = 0; i < 2; ++i) {
      partition::Block block;
      block.id = i;
      block.name = "r0c" + std::to_string(i);
      block.min_enu = {100.0 * i, 0.0, -5.0};
      block.max_enu = {100.0 * i + 100.0, 80.0, 20.0};
      block.margin_m = 8.0;
      block.altitude_agl_m = 100.0;
      block.gsd_m = 0.05;
      block.finest_voxel_m = 0.1;
      block.log2_table_size = 17;
      block.photos = {0, 1, 2};
      block.expected_pixels = 1e6;
      block.cost = 1.0;
      set.blocks.push_back(block);
    }
    const TemporaryFolder folder;
    partition::SaveBlocks(set, folder / "blocks.geojson");
    seeds.push_back(base::ReadFile(folder / "blocks.geojson"));
  }
  return seeds;
}

void Feed(const std::string& bytes) {
  static const TemporaryFolder folder;
  const std::filesystem::path file = folder / "blocks.geojson";
  std::ofstream(file, std::ios::binary) << bytes;
  try {
    partition::LoadBlocks(file);
  } catch (const base::InputError&) {
  }
}

}  // namespace skyquilt::fuzz
