// Small PNG images of the maps, for a quick look and for the report.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/image.h"
#include "core/scene/scene.h"
#include "products/map_rays.h"

namespace skyquilt::products {

// Heights as colours from the 2nd to the 98th percentile, shaded by a light in the north-west, 45 degrees up; white where NaN.
// cell_m: size of a pixel on the ground. Row 0 is the northern edge.
image::Image8 ShadedRelief(const image::ImageF& height_m, double cell_m);

// Reads an orthophoto and writes it as PNG, at most max_width pixels wide: axes east and north, over the scene's box. Where it has no data the PNG is
// transparent. Throws base::InputError.
void WriteOrthophotoPicture(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::filesystem::path& orthophoto,
                            const std::filesystem::path& png, int max_width);
// Reads the first band of a trust map (products/trust_map.h) and writes it as PNG in colours, white where it has no data.
void WriteTrustPicture(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::filesystem::path& trust_map,
                       const std::filesystem::path& png, int max_width);
// Writes orthophoto.json (products/map_products.h); preview: what a preview was made from, empty for the orthophoto itself. Throws base::InputError.
void WriteMapBounds(const scene::SceneInfo& info, const gis::MapGrid& grid, const std::filesystem::path& file, const std::string& preview = "");

// Reads the maps from their files (an empty path skips one) and writes orthophoto.png, dsm.png and orthophoto.json into `folder`, at most
// preview_width pixels wide. orthophoto.json has the first grid. Image axes are east and north of the survey's ENU frame, not those of the map
// projection. Throws base::InputError.
void WriteMapPreviews(const scene::SceneInfo& info, const gis::MapGrid& ortho_grid, const std::filesystem::path& orthophoto,
                      const gis::MapGrid& dsm_grid, const std::filesystem::path& dsm, const std::filesystem::path& folder, int preview_width);

}  // namespace skyquilt::products
