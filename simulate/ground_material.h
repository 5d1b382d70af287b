// Appearance of a city's ground, asphalt with markings, pavements, gardens, fields, and of a bridge.
#pragma once

#include "simulate/city_layout.h"
#include "simulate/surface.h"

namespace skyquilt::simulate {

Surface CityGround(const CityLayout& layout, const Hit& hit, uint32_t seed);
// Asphalt and concrete.
Surface BridgeSurface(const Bridge& bridge, const Hit& hit, uint32_t seed);
// Water of a pond, with small waves.
Surface PondWater(const Hit& hit, uint32_t seed);
// Unit normal of gentle waves. Waves smaller than the footprint fade out. slope: of the longest wave.
Eigen::Vector3f WaveNormal(float east, float north, float wavelength_m, float slope, float footprint_m, uint32_t seed);

}  // namespace skyquilt::simulate
