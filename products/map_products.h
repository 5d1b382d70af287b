// Makes the maps of a scene, orthophoto and digital surface model. The scene is rendered with one vertical ray per map cell; with the photos at hand
// the orthophoto is painted from them at their own resolution (photo_map/photo_orthophoto.h, which lists more files). Files:
//   orthophoto.tif  red, green, blue, alpha bytes (display values); alpha 0 where the scene has no surface
//   dsm.tif         float32 height of the surface in metres, above what products.vertical says and its CRS names (core/scene/map_heights.h), local z
//                   without geo-reference; no data: -9999
//   orthophoto.png, dsm.png   previews, north of the local frame up, white where there is no data; dsm.png is a shaded relief
//   orthophoto.json           ENU bounds of both previews (min_enu, max_enu: x, y in metres), resolution, CRS and accuracy of the maps
// The GeoTIFFs say in their metadata how well their place is known (products/place_metadata.h).
// A preview of the orthophoto (products/preview_files.h) in the same folder is removed when the orthophoto is complete.
// products.boundary limits both to the cells whose centre is inside.
// The surface is where the transmittance along the vertical ray falls below one half.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "products/map_rays.h"
#include "products/photo_map/photo_orthophoto.h"
#include "products/product_options.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

struct MapProducts {
  gis::MapGrid grid;                 // of the orthophoto when it is made, otherwise of the surface model
  std::filesystem::path orthophoto;  // empty when not made; dsm likewise
  std::filesystem::path dsm;
  double filled = 0.0;  // share of the rendered cells inside the scene's box that have data, 0..1
  int64_t rays = 0;
  std::optional<PhotoOrthophoto> painted;  // nothing when the orthophoto was rendered
};

// Of the memory that the program may use: a quarter, and no more than photos of neighbouring tiles need.
size_t PictureMemory(double limit_bytes);

// Writes into `folder`, which is created. photos: null when there are none; they are used if options.ortho_source says so. rays_per_call: of the
// caster (see RaysPerCall), which changes no bit. Deterministic. For a scene
// without geo-reference the files have no CRS, with a warning. Files are complete or absent. Throws base::UsageError (see PlanMapGrid),
// base::InputError when a file cannot be written, and base::Interrupted.
MapProducts MakeMapProducts(const scene::SceneInfo& info, const RayCaster& caster, const ProductOptions& options, const std::filesystem::path& folder,
                            const MapPhotos* photos = nullptr, size_t rays_per_call = RaysPerCall(1));
MapProducts MakeMapProducts(const scene::Scene& scene, const ProductOptions& options, const std::filesystem::path& folder, base::ThreadPool& threads,
                            const MapPhotos* photos = nullptr);
// One line about the size of the maps, and what the orthophoto was made from.
void LogMaps(const MapProducts& made, const std::filesystem::path& folder);

}  // namespace skyquilt::products
