// Shaded relief of a height raster.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "surface/maps/height_raster.h"

namespace skyquilt::surface {

// Lambert's cosine law for light from the north-west of the grid, 45 degrees high, with slopes after Horn 1981: 1 in the shade to 255 facing the
// light, 181 for level ground; 0 without height. Where neighbours are missing the slope is that of the others.
std::vector<uint8_t> Hillshade(const HeightRaster& raster, base::ThreadPool& threads);

}  // namespace skyquilt::surface
