// The second picture of a survey: a field that is trained already, seen straight down, at modest size. It replaces the preview from sparse points.
#pragma once

#include <filesystem>

#include "products/preview_files.h"
#include "products/product_options.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

// At most and at least this many cells, whatever the time.
constexpr double kMostFieldCells = 1e6;
constexpr double kFewestFieldCells = 2e4;

struct FieldPreview {
  std::filesystem::path picture;  // the .png
  gis::MapGrid grid;
  double filled = 0.0;  // share of the cells with data, 0..1
};

// Writes the preview (products/preview_files.h), made from the context, into `folder`. info: place and box of the field; info.gsd_m: its finest
// detail, metres. The size of the map, and nothing else, follows from the measured speed of the caster, so that rendering takes about `seconds`.
// options: boundary and min_opacity count. Throws base::UsageError as BoundaryOf, base::InputError when a file cannot be written,
// base::Interrupted.
FieldPreview MakeFieldPreview(const scene::SceneInfo& info, const RayCaster& caster, double seconds, const ProductOptions& options,
                              const std::filesystem::path& folder);

}  // namespace skyquilt::products
