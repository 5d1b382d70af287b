// Cuts the surface of a tile into charts: pieces that are projected onto the texture along one direction.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "surface/texture/chart_directions.h"
#include "surface/texture/raster.h"
#include "surface/texture/tile_geometry.h"

namespace skyquilt::surface {

// Least cosine between a triangle's normal and the direction of its chart.
constexpr double kLeastChartCosine = 0.3;

// Texels of all charts of one direction lie on the same lattice.
struct TexelLattice {
  ChartDirections directions;
  Eigen::Vector3d origin_enu = Eigen::Vector3d::Zero();
  double texel_m = 0.0;

  Eigen::Vector2d At(int direction, const Eigen::Vector3d& x_in_enu) const {
    const ChartDirection& d = directions[static_cast<size_t>(direction)];
    const Eigen::Vector3d x = (x_in_enu - origin_enu) / texel_m;
    return {d.u.dot(x), d.v.dot(x)};
  }
  // Distance along the direction, in texels.
  double DepthAt(int direction, const Eigen::Vector3d& x_in_enu) const {
    return directions[static_cast<size_t>(direction)].out.dot(x_in_enu - origin_enu) / texel_m;
  }
  TexelTriangle Of(int direction, const TileGeometry& geometry, size_t t) const {
    return {At(direction, geometry.Corner(t, 0)), At(direction, geometry.Corner(t, 1)), At(direction, geometry.Corner(t, 2))};
  }
};

struct Chart {
  int direction = 0;
  std::vector<uint32_t> triangle;                    // of the geometry
  Eigen::Vector2i corner = Eigen::Vector2i::Zero();  // first texel on the lattice
  Eigen::Vector2i size = Eigen::Vector2i::Zero();    // texels; the whole chart lies inside
};

// Pieces of one direction each, connected by edges: the best direction of each triangle, without single triangles and small pieces where their
// neighbours' direction fits too. Triangles in rising order. corner and size are not set.
std::vector<Chart> ConnectedCharts(const TileGeometry& geometry, const ChartDirections& directions, double texel_m);

// Splits a connected piece into charts in which no two triangles lie behind each other, to the resolution of a texel: each is grown from its first
// triangle over neighbours as long as they meet no texel of the same chart. Nothing when the piece is wider or higher than max_size texels.
std::optional<std::vector<Chart>> SplitOverlaps(const TileGeometry& geometry, const TexelLattice& lattice, const Chart& piece, int max_size);

// All charts of a tile. Nothing when one is larger than max_size texels. Each triangle is in one chart.
std::optional<std::vector<Chart>> MakeCharts(const TileGeometry& geometry, const TexelLattice& lattice, int max_size);

}  // namespace skyquilt::surface
