// Writes the orthophoto that is painted from the photos of a survey (photo_map.h). Files:
//   orthophoto.tif      red, green, blue, alpha bytes, at the photos' resolution; transparent outside the cutline
//   ortho_sources.tif   uint16 per cell: 0 no data, 1 the trained field, 2 + i photo number i of the survey
//   ortho_sources.json  {"cell_m", "cells": with data, "field_cells", "photos": {name: {"value", "cells"}}}
//   cutline.gpkg        outline of the ground that at least two photos see (map_edge.h); cells outside have no data
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/gis/boundary.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "products/photo_map/tile_service.h"
#include "products/product_options.h"

namespace skyquilt::products {

// The trained field seen straight down.
struct FieldMap {
  gis::MapGrid grid;
  std::vector<uint8_t> rgba;    // display values; alpha 0 without surface
  std::vector<float> height_m;  // as of MapProjection; NaN without surface
};

// What an orthophoto is painted from.
struct MapPhotos {
  const survey::Survey& survey;
  size_t memory;  // bytes that photos in memory may take
  base::ThreadPool& threads;
  TileService* elsewhere = nullptr;  // paints the tiles; null: this process does
};

struct PhotoOrthophoto {
  gis::MapGrid grid;
  int photos = 0;      // that show cells
  int unreadable = 0;  // photos
  int64_t cells = 0, field_cells = 0;
  double painting_s = 0.0;  // for tiles, here or elsewhere: work that is divided among ranks
  gis::Boundary cutline;    // in the grid's coordinates
};

// Cells of an orthophoto from these photos: their median ground sampling distance, rounded to 1, 2 or 5 times a power of ten; NaN when none looks
// down on the ground.
double PhotoResolution(const survey::Survey& survey, double ground_z);

// Held-out photos are not used. Nothing when no photo sees the ground or can be read, with a
// warning that says why; then no file is written. boundary limits the map further. The same bytes for any number of threads, here and elsewhere.
// Files are complete or absent. Throws base::UsageError for a requested resolution with too many cells, base::InputError when a file cannot be
// written, base::Interrupted.
std::optional<PhotoOrthophoto> WritePhotoOrthophoto(const scene::SceneInfo& info, const MapPhotos& photos, const FieldMap& field,
                                                    const ProductOptions& options, const std::optional<gis::Boundary>& boundary,
                                                    const std::filesystem::path& folder);

}  // namespace skyquilt::products
