#include "products/field_preview.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "products/map_area.h"
#include "products/map_rays.h"

namespace skyquilt::products {
namespace {

constexpr size_t kPreviewBatch = 1 << 15;  // rays
constexpr int kTrialRows = 16;
constexpr double kShareOfTime = 0.7;  // the rest is for what the trial does not show: writing the files, and other places

// Rays per second, from some rows of a small map.
double MeasureSpeed(const scene::SceneInfo& info, const RayCaster& caster) {
  const gis::MapGrid grid = PlanPreviewGrid(info, info.gsd_m, kFewestFieldCells);
  const MapRayGenerator generator(info, grid);
  std::vector<render::Ray> rays;
  MapRays row_rays;
  for (int i = 0; i < kTrialRows; ++i) {
    generator.MakeRow(static_cast<int>((i + 0.5) / kTrialRows * grid.height), &row_rays);
    rays.insert(rays.end(), row_rays.rays.begin(), row_rays.rays.end());
  }
  std::vector<render::RayColor> colors(rays.size());
  const auto begin = std::chrono::steady_clock::now();
  caster(rays, colors);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return static_cast<double>(rays.size()) / std::max(seconds, 1e-6);
}

struct WaitingRays {
  std::vector<render::Ray> rays;
  std::vector<size_t> cells;
};

void RenderWaiting(const RayCaster& caster, double min_opacity, WaitingRays* waiting, PreviewMap* map) {
  std::vector<render::RayColor> colors(waiting->rays.size());
  caster(waiting->rays, colors);
  for (size_t i = 0; i < colors.size(); ++i) {
    const render::RayColor& color = colors[i];
    if (!(static_cast<double>(color.opacity) >= min_opacity)) continue;
    uint8_t* rgba = map->rgba.data() + 4 * waiting->cells[i];
    for (size_t c = 0; c < 3; ++c) {
      // Premultiplied by opacity, which the map has not.
      const float straight = color.rgb_srgb[c] / color.opacity;
      rgba[c] = std::isfinite(straight) ? static_cast<uint8_t>(std::lround(255.0F * std::clamp(straight, 0.0F, 1.0F))) : uint8_t{0};
    }
    rgba[3] = 255;
  }
  waiting->rays.clear();
  waiting->cells.clear();
}

}  // namespace

FieldPreview MakeFieldPreview(const scene::SceneInfo& info, const RayCaster& caster, double seconds, const ProductOptions& options,
                              const std::filesystem::path& folder) {
  const double cells = std::clamp(kShareOfTime * seconds * MeasureSpeed(info, caster), kFewestFieldCells, kMostFieldCells);
  gis::MapGrid grid = PlanPreviewGrid(info, info.gsd_m, cells);
  const std::optional<gis::Boundary> boundary = BoundaryOf(grid, options);
  if (boundary) grid = CropTo(grid, *boundary);
  PreviewMap map{grid, std::vector<uint8_t>(4 * grid.size(), 0)};
  const std::vector<uint8_t> inside = boundary ? boundary->Mask(grid) : std::vector<uint8_t>(map.rgba.size() / 4, 1);
  const MapRayGenerator generator(info, grid);
  base::Progress progress("preview", static_cast<double>(grid.width) * grid.height, "cells");
  MapRays row_rays;
  WaitingRays waiting;
  for (int row = 0; row < grid.height; ++row) {
    base::ThrowIfCancelled();
    generator.MakeRow(row, &row_rays);
    for (size_t i = 0; i < row_rays.rays.size(); ++i) {
      const size_t cell = grid.Index(row_rays.column[i], row);
      if (inside[cell] == 0) continue;
      waiting.rays.push_back(row_rays.rays[i]);
      waiting.cells.push_back(cell);
    }
    if (waiting.rays.size() >= kPreviewBatch || row + 1 == grid.height) RenderWaiting(caster, options.min_opacity, &waiting, &map);
    progress.Update(static_cast<double>(row + 1) * grid.width);
  }
  progress.Finish();
  return {WritePreview(info, map, kFromContext, folder, kPreviewWidth), grid, map.Filled()};
}

}  // namespace skyquilt::products
