// A map of how far the scene can be trusted, seen straight down.
//   trust.tif  two bands of float32: "expected error", root mean square, display values from 0 to 1 (core/trust/trust.h); and "photos", how many
//              training photos show the place. No data where the scene has no surface: -1
//   trust.png  the expected error for people, from 0 to trust::kTopError in the colours of the report's error pictures; north of the local frame up
#pragma once

#include <filesystem>

#include "core/trust/trust.h"
#include "products/map_area.h"
#include "products/map_rays.h"
#include "products/product_options.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

// One ray per cell of PlanMapGrid, inside options.boundary. The folder is created. Returns the GeoTIFF. Throws as MakeMapProducts does.
std::filesystem::path WriteTrustMap(const trust::Trust& trust, const scene::SceneInfo& info, const RayCaster& caster, const ProductOptions& options,
                                    const std::filesystem::path& folder, base::ThreadPool& threads);

}  // namespace skyquilt::products
