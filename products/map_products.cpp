#include "products/map_products.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/gis/geotiff.h"
#include "core/scene/map_heights.h"
#include "products/height_shift.h"
#include "products/map_area.h"
#include "products/map_preview.h"
#include "products/place_metadata.h"
#include "products/preview_files.h"

namespace skyquilt::products {
namespace {

constexpr float kNoHeight = -9999.0F;
constexpr size_t kBatchRays = 1 << 16;

// Consecutive rows of both maps, written together.
struct Band {
  int first_row = 0;
  int n_rows = 0;
  std::vector<uint8_t> rgba;
  std::vector<float> height;
};

// Rays that wait to be rendered, and the cells their results belong to.
struct Pending {
  std::vector<render::Ray> rays;
  std::vector<size_t> cell;  // index in the band
  std::vector<double> start_height_m;
  std::vector<render::RayColor> colors;
};

uint8_t ToByte(float display_value) {
  return static_cast<uint8_t>(std::lround(255.0F * std::clamp(display_value, 0.0F, 1.0F)));
}

// Renders the waiting rays into the band. Returns the number of cells that got data.
int64_t RenderPending(const RayCaster& caster, double min_opacity, Pending* pending, Band* band) {
  pending->colors.assign(pending->rays.size(), {});
  caster(pending->rays, pending->colors);
  int64_t filled = 0;
  for (size_t i = 0; i < pending->rays.size(); ++i) {
    const render::RayColor& color = pending->colors[i];
    if (!(static_cast<double>(color.opacity) >= min_opacity)) continue;
    const size_t cell = pending->cell[i];
    // Rendered colours are premultiplied by opacity; the map's alpha is 0 or 255.
    for (size_t c = 0; c < 3; ++c) {
      const float straight = color.rgb_srgb[c] / color.opacity;
      band->rgba[4 * cell + c] = std::isfinite(straight) ? ToByte(straight) : uint8_t{0};
    }
    band->rgba[4 * cell + 3] = 255;
    // With min_opacity below one half a ray may have no median depth.
    const float depth = std::isfinite(color.depth_median) ? color.depth_median : color.depth;
    if (std::isfinite(depth)) band->height[cell] = static_cast<float>(pending->start_height_m[i] - static_cast<double>(depth));
    ++filled;
  }
  pending->rays.clear();
  pending->cell.clear();
  pending->start_height_m.clear();
  return filled;
}

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
  Band band;
  MapRays row_rays;
  Pending pending;
  int64_t filled = 0;
  for (band.first_row = 0; band.first_row < grid.height; band.first_row += gis::GeoTiffWriter::kTile) {
    base::ThrowIfCancelled();
    band.n_rows = std::min(gis::GeoTiffWriter::kTile, grid.height - band.first_row);
    const size_t cells = static_cast<size_t>(band.n_rows) * static_cast<size_t>(grid.width);
    band.rgba.assign(4 * cells, 0);
    band.height.assign(cells, kNoHeight);
    for (int row = 0; row < band.n_rows; ++row) {
      generator.MakeRow(band.first_row + row, &row_rays);
      for (size_t i = 0; i < row_rays.rays.size(); ++i) {
        if (boundary && !boundary->Contains(grid.CellCentre(row_rays.column[i], band.first_row + row))) continue;
        ++products.rays;
        pending.rays.push_back(row_rays.rays[i]);
        pending.cell.push_back(grid.Index(row_rays.column[i], row));
        pending.start_height_m.push_back(row_rays.start_height_m[i]);
        if (pending.rays.size() == kBatchRays) filled += RenderPending(caster, options.min_opacity, &pending, &band);
      }
      progress.Update(static_cast<double>(band.first_row + row) * grid.width);
    }
    filled += RenderPending(caster, options.min_opacity, &pending, &band);
    if (ortho) ortho->WriteRows(band.first_row, band.n_rows, std::span<const uint8_t>(band.rgba));
    shift.AddTo(band.first_row, kNoHeight, band.height);
    if (dsm) dsm->WriteRows(band.first_row, band.n_rows, std::span<const float>(band.height));
  }
  progress.Update(static_cast<double>(grid.width) * grid.height);
  if (ortho) ortho->Close();
  if (dsm) dsm->Close();
  progress.Finish();
  products.filled = products.rays > 0 ? static_cast<double>(filled) / static_cast<double>(products.rays) : 0.0;
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
