// Writes a point cloud as Entwine Point Tiles (entwine.io/entwine-point-tile.html) with the data type "binary", which viewers in a browser (Potree,
// and so WebODM) and PDAL read without a library for compression:
//   ept.json                       bounds, schema, CRS
//   ept-data/<depth>-<x>-<y>-<z>.bin
//   ept-hierarchy/0-0-0-0.json     points per node
//   ept-sources/list.json          the files that the points come from
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::odm::ept {

struct EptCrs {
  int epsg = 0;     // of the horizontal coordinates; 0: a local frame
  std::string wkt;  // of the whole
};

// files: parts of a cloud as surface::LasWriter writes them. `folder` is replaced; it is either complete or missing. Points beyond chunk_points are
// kept on disk beside it while they are sorted. The same files give the same bytes. Returns the number of points; nothing is written for none. Throws
// base::InputError (damaged file, disk full), base::Interrupted.
int64_t WriteEpt(const std::vector<std::filesystem::path>& files, const EptCrs& crs, const std::filesystem::path& folder,
                 size_t chunk_points = 4'000'000);

}  // namespace skyquilt::odm::ept
