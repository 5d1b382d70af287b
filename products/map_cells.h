// Renders the cells of a map: what a scene shows straight down.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "core/gis/boundary.h"
#include "core/gis/map_grid.h"
#include "products/cell_painter.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

inline constexpr float kNoHeight = -9999.0F;  // of cells without surface

// How the cells of a map are rendered. Keeps a reference.
struct MapCasting {
  const RayCaster& caster;
  size_t rays_per_call = RaysPerCall(1);  // of the caster, at least 1; changes no bit
  double min_opacity = 0.0;               // cells with a lower opacity have no data
  // Where the rays through every second cell of every second row show one surface (highest minus lowest of the four around at most two cells, up to
  // 45 degrees), the cells between get heights and colours between; a ray is cast through each of the others. For cells finer than the scene's
  // detail.
  bool every_second = false;
};

struct RenderedCells {
  int64_t inside = 0;  // cells inside the scene's box and the boundary
  int64_t filled = 0;  // of those, cells that have data
  int64_t rays = 0;
};

// Gets consecutive rows from the first on, 512 at most at a time: colours, and heights of the surface as MapRays has them (kNoHeight: none). May
// change the cells.
using MapRowSink = std::function<void(int first_row, int n_rows, PaintedCells& cells)>;

// what: of the progress bar. Cells whose centre is outside the boundary have no data. Throws base::Interrupted and what the sink throws.
RenderedCells RenderMapCells(const scene::SceneInfo& info, const gis::MapGrid& grid, const MapCasting& casting,
                             const std::optional<gis::Boundary>& boundary, const char* what, const MapRowSink& sink);

}  // namespace skyquilt::products
