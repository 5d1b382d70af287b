// Other forms of finished maps: coarser, and as a picture.
#pragma once

#include <filesystem>

namespace skyquilt::gis {

// Writes the map again with larger cells, as a cloud-optimised GeoTIFF with its place, values, metadata and no-data value: means of the known cells.
// An orthophoto of 3 bands with a mask is JPEG-compressed again, one of 4 with alpha without loss. cell_m must not be smaller than the map's cells.
// Throws base::InputError, base::Interrupted.
void WriteCoarserMap(const std::filesystem::path& from, const std::filesystem::path& to, double cell_m);

// An orthophoto as PNG with alpha, and its world file beside it (.wld: cell size, rotation and the centre of the first cell). Throws
// base::InputError, base::Interrupted.
void WriteMapPicture(const std::filesystem::path& from, const std::filesystem::path& png);

}  // namespace skyquilt::gis
