// Reads back the maps that this program wrote: where a raster lies, and contour lines.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/gis/map_grid.h"

namespace skyquilt::gis {

// Size and place of a GeoTIFF; `georeferenced` and `zone` are left as they are by default, because the survey knows them. Throws base::InputError
// when the file cannot be read or is not north-up with square cells.
MapGrid ReadMapGrid(const std::filesystem::path& file);

struct ContourLine {
  double height_m = 0.0;
  bool index = false;                   // every fifth line
  std::vector<Eigen::Vector2d> map_xy;  // easting and northing, or local metres
};
// The layer "contours" of contours.gpkg, in its order. At most max_vertices are read: when there are more, only index lines, and of those as many as
// fit; `thinned` tells. Throws base::InputError when it cannot be read.
struct Contours {
  std::vector<ContourLine> lines;
  bool thinned = false;
};
Contours ReadContours(const std::filesystem::path& gpkg, int64_t max_vertices);

}  // namespace skyquilt::gis
