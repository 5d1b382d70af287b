// Blocks: the geo-referenced boxes in which separate fields are trained.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geo/block_box.h"
#include "core/geo/geodetic.h"

namespace skyquilt::partition {

struct Block : geo::BlockBox {
  int id = 0;                   // position in BlockSet::blocks
  std::string name;             // "r0c1": row from the south, column from the west
  double altitude_agl_m = 0.0;  // of the cameras that see it: given, or from the flight
  double gsd_m = 0.0;           // ground sampling distance at that altitude and the training image width
  double finest_voxel_m = 0.0;
  int log2_table_size = 0;
  std::vector<int> photos;       // indices into Survey::photos whose rays cross the box, training and test
  double expected_pixels = 0.0;  // training pixels whose ray crosses the box
  double cost = 0.0;             // relative share of training time, > 0 unless empty
  bool empty = false;
  std::string empty_reason;
};

struct BlockSet {
  geo::Geodetic origin;
  bool georeferenced = false;
  int rows = 0;
  int columns = 0;
  int image_width = 0;        // training width the capacities were computed for; 0 = full size
  std::string config_hash;    // of the options and survey that made it
  std::vector<Block> blocks;  // row-major from the south-west
};

// RFC 7946 FeatureCollection: polygons in longitude, latitude (counter-clockwise); everything of Block as properties.
// Without geo-reference the local metres are written as they are and the file says so in "skyquilt:georeferenced": false.
// Throws base::InputError.
void SaveBlocks(const BlockSet& blocks, const std::filesystem::path& file);
BlockSet LoadBlocks(const std::filesystem::path& file);

}  // namespace skyquilt::partition
