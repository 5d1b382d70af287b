// Pictures of the maps for people and for the report.
#pragma once

#include <filesystem>

#include "core/image/image.h"
#include "core/scene/scene.h"
#include "products/map_rays.h"

namespace skyquilt::products {

// Height as colour between its 2nd and 98th percentile, shaded by a light in the north-west, 45 degrees up; white where NaN.
// `cell_m` is the size of a pixel on the ground. Row 0 in the north.
image::Image8 ShadedRelief(const image::ImageF& height_m, double cell_m);

// Reads the maps back from their files (an empty path skips one) and writes orthophoto.png, dsm.png and orthophoto.json into `folder`.
// The previews show the scene's box in ENU, so that their edges are straight in the survey's own frame. Throws base::InputError.
void WriteMapPreviews(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::filesystem::path& orthophoto,
                      const std::filesystem::path& dsm, const std::filesystem::path& folder, int preview_width);

}  // namespace skyquilt::products
