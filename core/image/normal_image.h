// Pictures of surface normals: PNG with 16 bits per channel. Red, green and blue are the components to the east, north and up of a unit vector that
// points out of the surface; a component n is stored as round(32768 + 32767 n). Black (0, 0, 0): no surface.
#pragma once

#include <filesystem>

#include "core/image/image.h"

namespace skyquilt::image {

// normals: three channels, unit vectors in ENU; pixels with a NaN have no normal. Writes atomically; throws base::InputError.
void SaveNormals(const ImageF& normals, const std::filesystem::path& file);
// Unit vectors, and NaN where there is none. Throws base::InputError for files that are not RGB with 16 bits per channel.
ImageF LoadNormals(const std::filesystem::path& file);
// The same colours with 8 bits per channel, for pages.
Image8 ShowNormals(const ImageF& normals);

}  // namespace skyquilt::image
