// Blocks: the geo-referenced boxes in which separate fields are trained, and the file blocks.geojson that keeps them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geo/block_box.h"
#include "core/geo/geodetic.h"
#include "core/geo/height_reference.h"
#include "core/geo/place_accuracy.h"

namespace skyquilt::partition {

struct Block : geo::BlockBox {
  int id = 0;                    // position in BlockSet::blocks
  std::string name;              // "r0c1": row from the south, column from the west
  double altitude_agl_m = 0.0;   // of the cameras above it (altitude.h): from the options or from the flight
  double flown_agl_m = 0.0;      // the same from the flight, whatever the options say; 0 in files of older programs
  double gsd_m = 0.0;            // at the training width, on its points (seen_gsd.h) or from a given altitude, no finer than the photos' pixels
  double finest_voxel_m = 0.0;   // cell size of the finest level of its encoding
  int log2_table_size = 0;       // of its hash tables; 0 when empty
  std::vector<int> photos;       // indices into Survey::photos: training photos that see the box; in files of older programs held-out ones, too
  double expected_pixels = 0.0;  // training pixels whose ray crosses the box
  double cost = 0.0;             // estimated share of the total training time, > 0 unless empty
  bool empty = false;            // not trained
  std::string empty_reason;
};

struct BlockSet {
  geo::Geodetic origin;
  bool georeferenced = false;
  // Of the survey; unknown in files of older programs.
  geo::PlaceAccuracy accuracy;
  geo::HeightReference height_reference = geo::HeightReference::kUnknown;
  int rows = 0;
  int columns = 0;
  int image_width = 0;        // training width the capacities were computed for; 0 = full size
  std::string config_hash;    // of the options and the survey the blocks were made from
  std::vector<Block> blocks;  // row-major from the south-west
  // For the log; not in the file.
  std::string number_reason;            // what decided how many there are, to follow "2 x 3 blocks: "
  bool area_is_that_of_points = false;  // because photos cover no ground
};

// Writes or reads a GeoJSON FeatureCollection (RFC 7946): polygons in longitude, latitude (counter-clockwise), the fields of Block as properties.
// Without geo-reference the polygons are in local metres and "skyquilt:georeferenced" is false.
// Throws base::InputError when the file cannot be written, read or used.
void SaveBlocks(const BlockSet& blocks, const std::filesystem::path& file);
BlockSet LoadBlocks(const std::filesystem::path& file);

}  // namespace skyquilt::partition
