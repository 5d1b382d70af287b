// What a map says about its place on Earth: how it was found and how accurate it is.
#pragma once

#include <map>
#include <string>

#include "core/gis/geotiff.h"
#include "core/scene/scene.h"

namespace skyquilt::products {

// "exact (simulated)", "fitted to GPS tags", "of unknown accuracy" (a scene of an older program) or "local frame".
std::string NameOfGeoreference(const scene::SceneInfo& info);

// Items for a GeoTIFF: GEOREFERENCE; ACCURACY_SCALE_PERCENT, ACCURACY_TILT_DEG, ACCURACY_YAW_DEG, ACCURACY_HORIZONTAL_M and ACCURACY_VERTICAL_M, one
// standard deviation each as a decimal number, or "unknown"; and TIFFTAG_IMAGEDESCRIPTION, one ASCII sentence that begins with `title`.
std::map<std::string, std::string> PlaceMetadata(const scene::SceneInfo& info, const std::string& title);

// The GeoTIFF of an orthophoto: red, green, blue and alpha bytes, with this metadata.
gis::GeoTiffSpec OrthophotoSpec(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::string& title);

}  // namespace skyquilt::products
