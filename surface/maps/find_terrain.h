// Bare ground from a surface: a progressive morphological filter (Zhang et al. 2003). Used by everything that needs ground: DTM, classes of the
// cloud, closing of holes.
//
// In working cells, each with a low height (10th percentile) of its cells and without small pits (low_outliers.h), square windows grow from three
// cells to window_m. What an opening with a window lowers by more than low_m + slope * (growth of the window), at most high_m, stands on the ground.
// Windows grow by a quarter, but at most so much that the threshold stays near 1 m: low sheds are found and slopes are kept. Ground between objects
// and in gaps is filled smoothly (fill_smoothly.h). Limits: what is wider than window_m all around, or joins the ground by a ramp, counts as ground;
// terraces narrower than window_m with steps above the threshold do not, nor do slopes steeper than twice `slope`.
#pragma once

#include "surface/maps/height_raster.h"

namespace skyquilt::surface {

// Checked by SurfaceOptions::Check; must be positive, but slope may be 0.
struct TerrainOptions {
  double cell_m = 0.5;     // working cells; each holds the lowest robust height in it
  double window_m = 60.0;  // largest window: the size of the largest building
  double slope = 0.3;      // steepest ground
  double low_m = 0.3;      // first threshold
  double high_m = 3.0;     // largest threshold
};

struct Terrain {
  // Of the same grid as the surface. Where the surface is ground its heights, lightly smoothed. Gaps and what stands on the ground are filled;
  // outside the outline of the surface, after gaps up to window_m wide were closed, NaN. The outline is that of working cells.
  HeightRaster height;
  std::vector<uint8_t> is_ground;  // per cell: 1 where the surface itself is ground, within low_m and what the ground rises in a working cell
};
// A surface without heights gives a terrain without. Deterministic. Throws base::Interrupted.
Terrain FindTerrain(const HeightRaster& surface, const TerrainOptions& options);

}  // namespace skyquilt::surface
