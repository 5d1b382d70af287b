// Appearance of a tidal flat: rippled sand, darker and mirroring where wet, and water in the channels.
#pragma once

#include "simulate/surface.h"
#include "simulate/terrain.h"

namespace skyquilt::simulate {

Surface TidalSand(const Hit& hit, float water_z_m, uint32_t seed);
// The bed is visible through shallow water.
Surface TidalWater(const Terrain& bed, const Hit& hit, uint32_t seed);

}  // namespace skyquilt::simulate
