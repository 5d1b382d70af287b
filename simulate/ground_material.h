// How the ground of a city looks: asphalt with markings, pavements, gardens, fields.
#pragma once

#include "simulate/city_layout.h"
#include "simulate/surface.h"

namespace skyquilt::simulate {

Surface CityGround(const CityLayout& layout, const Hit& hit, uint32_t seed);
// The pond's water: bed darkened by depth, small waves.
Surface PondWater(const Hit& hit, uint32_t seed);
// Normal of gentle waves, faded where they fall below the footprint. slope: of the longest wave.
Eigen::Vector3f WaveNormal(float east, float north, float wavelength_m, float slope, float footprint_m, uint32_t seed);

}  // namespace skyquilt::simulate
