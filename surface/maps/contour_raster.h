// What contour lines are drawn from: coarser and smoother ground than the terrain model, so that lines are not drawn around noise.
#pragma once

#include <cstdint>
#include <vector>

#include "surface/maps/height_raster.h"

namespace skyquilt::surface {

struct ContourRaster {
  HeightRaster heights;     // cells of about cell_m, a multiple of those of the terrain
  double interval_m = 0.1;  // suggested: 1, 2 or 5 times a power of ten, 16 to 40 levels, but not below 0.1 m and four times the noise of a cell
};

// mask: per cell of the terrain, 0: left out; empty: none is.
ContourRaster MakeContourRaster(const HeightRaster& terrain, const std::vector<uint8_t>& mask, double cell_m);

// The smallest of 1, 2, 5 times a power of ten that is not below the value; value > 0.
double NiceNumberAbove(double value);

}  // namespace skyquilt::surface
