// Contour lines of a height raster, as a GeoPackage that every GIS reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "core/gis/map_grid.h"

namespace skyquilt::gis {

// Writes the layer "contours": lines where the height, linear between cell centres, is a multiple of interval_m. Fields: height_m (real), index
// (integer: 1 for every fifth line, else 0). Lines are ordered by height. CRS: the grid's zone, none without geo-reference; lines have no z.
// `vertical`, what heights are above, goes into the layer's description, `metadata` into its items. height_m: [row][column] of the grid, NaN where
// there is none; lines end there. A raster without any line, even one without cells, gives an empty layer. The interval is that of
// AllowedContourInterval, with a warning when it is larger than asked for. Returns the number of lines. Written under another name and renamed; the
// same raster gives the same bytes, so the file's time stamp is fixed. Throws base::InputError when it cannot be written, base::Interrupted.
int64_t WriteContours(const MapGrid& grid, std::span<const float> height_m, double interval_m, const std::string& vertical,
                      const std::filesystem::path& gpkg, const std::map<std::string, std::string>& metadata = {});

// The interval itself, or 2, 5, 10, ... times as much when it would give more than 1000 heights.
double AllowedContourInterval(std::span<const float> height_m, double interval_m);

}  // namespace skyquilt::gis
