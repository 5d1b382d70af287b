// Where the charts of a tile are in its texture.
#pragma once

#include <vector>

#include "surface/texture/charts.h"

namespace skyquilt::surface {

// Texels around each chart that belong to it and repeat its border, so that neither interpolation nor smaller copies of the texture mix charts.
constexpr int kGutterTexels = 2;

struct AtlasLayout {
  TexelLattice lattice;
  std::vector<Chart> charts;
  std::vector<Eigen::Vector2i> corner;  // per chart: its first texel in the atlas, inside its gutter
  int width = 0, height = 0;            // multiples of kAtlasMultiple; 0 without charts

  // Pixels of the atlas, its corner is (0, 0).
  Eigen::Vector2d PixelOf(size_t chart, const Eigen::Vector3d& x_in_enu) const {
    const Chart& c = charts[chart];
    return lattice.At(c.direction, x_in_enu) + (corner[chart] - c.corner).cast<double>();
  }
};

// texel_m: made larger in steps of 1.25 until the atlas is at most max_atlas pixels wide and high. It may become larger only where there are so many
// charts that texels of any size would not do.
AtlasLayout LayOutAtlas(const TileGeometry& geometry, double texel_m, int max_atlas);

// Vertices, triangles and texture coordinates; vertices are repeated per chart. The texture itself stays empty.
TexturedTile LaidOutTile(const MeshTile& mesh, const TileGeometry& geometry, const AtlasLayout& layout);

}  // namespace skyquilt::surface
