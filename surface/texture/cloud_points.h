// Points of the cloud: places on the mesh at even distances, with the colours of the texture.
#pragma once

#include "core/image/image.h"
#include "surface/texture/texels.h"

namespace skyquilt::surface {

// About one point per spacing_m^2 of surface: texels of each chart on an even grid, more densely where the surface is inclined to the chart's
// direction, but at most one per texel. A chart with at least half as much surface has at least one. Nothing when spacing_m is not above 0.
std::vector<CloudPoint> PointsOf(const TileGeometry& geometry, const AtlasLayout& layout, const AtlasTexels& texels, const image::Image8& atlas,
                                 double spacing_m);

}  // namespace skyquilt::surface
