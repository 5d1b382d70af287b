#include "coordinator/stages/surface_edge.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/gis/map_projection.h"
#include "products/photo_map/map_edge.h"

namespace skyquilt::coordinator {
namespace {

constexpr int kFewestPhotos = 2;     // one photo does not tell a distance
constexpr double kEnoughArea = 0.8;  // of the area that kFewestPhotos see
constexpr double kNodesPerCell = 2.0;
constexpr int kNodesAround = 2;

using Rings = std::vector<std::vector<Eigen::Vector2d>>;

products::SeenLattice LatticeOf(const scene::Background& background, const scene::SceneInfo& info, const gis::MapGrid& grid) {
  products::SeenLattice seen{.grid = grid, .photos = {}};
  const double node_m = std::max(grid.resolution_m, background.surface.grid().cell_m / kNodesPerCell);
  seen.grid.resolution_m = node_m;
  // The outline stays half a node within the lattice, and must not cut the grid.
  seen.grid.left -= kNodesAround * node_m;
  seen.grid.top += kNodesAround * node_m;
  seen.grid.width = static_cast<int>(std::ceil(grid.width * grid.resolution_m / node_m)) + 2 * kNodesAround;
  seen.grid.height = static_cast<int>(std::ceil(grid.height * grid.resolution_m / node_m)) + 2 * kNodesAround;
  const gis::MapProjection projection(info.origin, grid);
  const geo::PlaneGrid& cells = background.surface.grid();
  const Eigen::Vector2d low = cells.origin, high = low + cells.cell_m * Eigen::Vector2d(cells.columns, cells.rows);
  seen.photos.reserve(seen.grid.size());
  for (int row = 0; row < seen.grid.height; ++row) {
    for (int column = 0; column < seen.grid.width; ++column) {
      const gis::MapProjection::VerticalLine line = projection.VerticalLineAt(seen.grid.CellCentre(column, row));
      const double z = background.surface.At(line.start_enu.x(), line.start_enu.y());
      const Eigen::Vector2d x = (line.start_enu + (z - line.start_enu.z()) / line.down_enu.z() * line.down_enu).head<2>();
      double photos = 0.0;
      if ((x.array() >= low.array()).all() && (x.array() <= high.array()).all()) {
        const scene::HeightMap::Corners corners = background.surface.Around(x.x(), x.y());
        for (size_t i = 0; i < 4; ++i) photos += corners.weight[i] * background.photos[corners.cell[i]];
      }
      seen.photos.push_back(static_cast<uint8_t>(std::lround(photos)));
    }
  }
  return seen;
}

double AreaOf(const Rings& rings) {
  double doubled = 0.0;  // holes run the other way round
  for (const std::vector<Eigen::Vector2d>& ring : rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d a = ring[i] - ring.front(), b = ring[(i + 1) % ring.size()] - ring.front();
      doubled += a.x() * b.y() - a.y() * b.x();
    }
  }
  return 0.5 * doubled;
}

}  // namespace

std::optional<gis::Boundary> SurfaceEdge(const scene::Background& background, const scene::SceneInfo& info, const gis::MapGrid& grid, int photos) {
  if (background.photos.empty()) return std::nullopt;
  const products::SeenLattice seen = LatticeOf(background, info, grid);
  Rings rings = CutlineOf(seen, kFewestPhotos, 0.0);
  if (rings.empty()) return std::nullopt;
  const double enough = kEnoughArea * AreaOf(rings);
  for (int least = photos; least > kFewestPhotos; --least) {
    Rings fewer = CutlineOf(seen, least, 0.0);
    if (AreaOf(fewer) < enough) continue;
    rings = std::move(fewer);
    break;
  }
  return gis::Boundary(std::move(rings));
}

}  // namespace skyquilt::coordinator
