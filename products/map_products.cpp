#include "products/map_products.h"

#include <algorithm>
#include <chrono>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/gis/geotiff.h"
#include "core/scene/map_heights.h"
#include "products/cell_painter.h"
#include "products/height_shift.h"
#include "products/map_area.h"
#include "products/map_preview.h"
#include "products/place_metadata.h"
#include "products/preview_files.h"

namespace skyquilt::products {
namespace {

constexpr float kNoHeight = -9999.0F;

gis::GeoTiffSpec DsmSpec(const scene::SceneInfo& info, const scene::MapHeights& heights, const gis::MapGrid& grid) {
  gis::GeoTiffSpec spec;
  spec.grid = grid;
  spec.type = gis::PixelType::kFloat32;
  spec.nodata = static_cast<double>(kNoHeight);
  spec.band_names = {!grid.georeferenced                                       ? "local height"
                     : heights.reference() == geo::HeightReference::kEllipsoid ? "ellipsoidal height"
                                                                               : "height"};
  spec.unit = "m";
  spec.heights = heights.reference();
  spec.metadata = PlaceMetadata(info, "Digital surface model");
  spec.metadata.merge(heights.Metadata());
  spec.metadata["TIFFTAG_SOFTWARE"] = "skyquilt";
  return spec;
}

}  // namespace

MapProducts MakeMapProducts(const scene::SceneInfo& info, const RayCaster& caster, const ProductOptions& options,
                            const std::filesystem::path& folder) {
  const auto begin = std::chrono::steady_clock::now();
  MapProducts products;
  products.grid = PlanMapGrid(info, options);
  if (!options.ortho && !options.dsm) return products;
  const std::optional<gis::Boundary> boundary = BoundaryOf(products.grid, options);
  if (boundary) products.grid = CropTo(products.grid, *boundary);
  base::RequireWritableFolder(folder);
  const gis::MapGrid& grid = products.grid;
  if (!grid.georeferenced)
    base::LogWarning(
        "the survey has no geo-reference, so orthophoto and surface model are in local coordinates without CRS; use photos with GPS tags");
  const scene::MapHeights heights(info, options.dsm ? geo::VerticalNamed(options.vertical) : geo::Vertical::kAsTagged);
  if (!heights.Caution().empty()) base::LogWarning("{}", heights.Caution());
  HeightShift shift(heights, grid);
  std::optional<gis::GeoTiffWriter> ortho;
  std::optional<gis::GeoTiffWriter> dsm;
  if (options.ortho) ortho.emplace(products.orthophoto = folder / "orthophoto.tif", OrthophotoSpec(info, grid, "Orthophoto"));
  if (options.dsm) dsm.emplace(products.dsm = folder / "dsm.tif", DsmSpec(info, heights, grid));

  const MapRayGenerator generator(info, grid);
  base::Progress progress(options.ortho ? "orthophoto" : "surface model", static_cast<double>(grid.width) * grid.height, "cells");
  PaintedCells band;  // consecutive rows of both maps, written together
  MapRays row_rays;
  CellPainter painter(caster, options.min_opacity);
  for (int first_row = 0; first_row < grid.height; first_row += gis::GeoTiffWriter::kTile) {
    base::ThrowIfCancelled();
    const int n_rows = std::min(gis::GeoTiffWriter::kTile, grid.height - first_row);
    const size_t cells = static_cast<size_t>(n_rows) * static_cast<size_t>(grid.width);
    band.rgba.assign(4 * cells, 0);
    band.place.assign(cells, kNoHeight);
    for (int row = 0; row < n_rows; ++row) {
      generator.MakeRow(first_row + row, &row_rays);
      for (size_t i = 0; i < row_rays.rays.size(); ++i) {
        if (boundary && !boundary->Contains(grid.CellCentre(row_rays.column[i], first_row + row))) continue;
        ++products.rays;
        painter.Add(row_rays.rays[i], grid.Index(row_rays.column[i], row), row_rays.start_height_m[i], &band);
      }
      progress.Update(static_cast<double>(first_row + row) * grid.width);
    }
    painter.Finish(&band);
    if (ortho) ortho->WriteRows(first_row, n_rows, std::span<const uint8_t>(band.rgba));
    shift.AddTo(first_row, kNoHeight, band.place);
    if (dsm) dsm->WriteRows(first_row, n_rows, std::span<const float>(band.place));
  }
  progress.Update(static_cast<double>(grid.width) * grid.height);
  if (ortho) ortho->Close();
  if (dsm) dsm->Close();
  progress.Finish();
  products.filled = products.rays > 0 ? static_cast<double>(painter.painted()) / static_cast<double>(products.rays) : 0.0;
  WriteMapPreviews(info, grid, products.orthophoto, products.dsm, folder, kPreviewWidth);
  if (options.ortho) RemovePreviews(folder);
  products.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return products;
}

MapProducts MakeMapProducts(const scene::Scene& scene, const ProductOptions& options, const std::filesystem::path& folder,
                            base::ThreadPool& threads) {
  return MakeMapProducts(scene.info(), CasterOf(scene, AppearanceOf(options.exposure, scene.info()), threads), options, folder);
}

}  // namespace skyquilt::products
