// The texels that show the surface, each with its place on the mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "surface/texture/atlas_layout.h"

namespace skyquilt::surface {

struct Texel {
  uint32_t triangle = 0;       // of the geometry
  float b1 = 0.0F, b2 = 0.0F;  // place in it: barycentric weights of the second and third corner
  uint16_t x = 0, y = 0;       // pixel of the atlas
  bool border = false;         // its centre is outside the chart, and its place the nearest one in the chart
};

struct AtlasTexels {
  std::vector<Texel> texel;   // chart by chart, row by row
  std::vector<size_t> first;  // of each chart, and the end: one more than charts

  Eigen::Vector3d PositionOf(const TileGeometry& geometry, size_t i) const {
    const Texel& t = texel[i];
    return geometry.PositionAt(t.triangle, static_cast<double>(t.b1), static_cast<double>(t.b2));
  }
  Eigen::Vector3d NormalOf(const TileGeometry& geometry, size_t i) const {
    const Texel& t = texel[i];
    return geometry.NormalAt(t.triangle, static_cast<double>(t.b1), static_cast<double>(t.b2));
  }
};

// Texels whose centre is inside a chart, and those outside that its triangles touch or nearly touch (up to half a texel's diagonal from the centre).
AtlasTexels FindTexels(const TileGeometry& geometry, const AtlasLayout& layout, base::ThreadPool& threads);

}  // namespace skyquilt::surface
