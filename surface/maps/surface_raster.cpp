#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/progress.h"
#include "surface/maps/contour_raster.h"
#include "surface/maps/surface_maps.h"

namespace skyquilt::surface {
namespace {

constexpr double kMostCells = 100e6;

// Multiples of the resolution that a coordinate lies above and below. Rounding must not add a row of empty cells to an extent that ends at a
// multiple.
double MultiplesBelow(double coordinate, double resolution_m) {
  return std::floor(coordinate / resolution_m + 1e-9);
}
double MultiplesAbove(double coordinate, double resolution_m) {
  return std::ceil(coordinate / resolution_m - 1e-9);
}

// Draws triangles whose corners are in units of cells: x to the east, y to the south, whole numbers at centres; z in metres.
class TrianglePainter {
 public:
  explicit TrianglePainter(HeightRaster* raster) : raster_(raster) {}

  void Paint(const std::array<Eigen::Vector3d, 3>& corner) {
    const double low_y = std::min({corner[0].y(), corner[1].y(), corner[2].y()});
    const double high_y = std::max({corner[0].y(), corner[1].y(), corner[2].y()});
    const int first = FirstAtLeast(low_y, raster_->grid.height);
    const int last = LastAtMost(high_y, raster_->grid.height);
    if (first > last) return;
    const Eigen::Vector3d ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    const double area = ab.x() * ac.y() - ab.y() * ac.x();
    // A wall, seen from above a line.
    if (!(std::abs(area) > 1e-12)) return;
    const double dx = (ab.z() * ac.y() - ac.z() * ab.y()) / area;
    const double dy = (ac.z() * ab.x() - ab.z() * ac.x()) / area;
    const double low_z = std::min({corner[0].z(), corner[1].z(), corner[2].z()});
    const double high_z = std::max({corner[0].z(), corner[1].z(), corner[2].z()});
    for (int row = first; row <= last; ++row) {
      // Both triangles at an edge compute the same crossing and include it, so that no centre is left out between them.
      double west = std::numeric_limits<double>::infinity(), east = -west;
      for (size_t i = 0; i < 3; ++i) Cross(corner[i], corner[(i + 1) % 3], row, &west, &east);
      const int last_column = LastAtMost(east, raster_->grid.width);
      for (int column = FirstAtLeast(west, raster_->grid.width); column <= last_column; ++column) {
        // Rounding in steep triangles must not lead out of their range of heights.
        const double z = std::clamp(corner[0].z() + dx * (column - corner[0].x()) + dy * (row - corner[0].y()), low_z, high_z);
        float& height = raster_->height_m[raster_->grid.Index(column, row)];
        if (!(height >= static_cast<float>(z))) height = static_cast<float>(z);
      }
    }
  }

 private:
  // Widens [west, east] by where the edge crosses the row.
  static void Cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b, int row, double* west, double* east) {
    const bool ordered = std::pair(a.y(), a.x()) < std::pair(b.y(), b.x());
    const Eigen::Vector3d& low = ordered ? a : b;
    const Eigen::Vector3d& high = ordered ? b : a;
    if (!(low.y() <= row && high.y() >= row)) return;
    if (low.y() == high.y()) {
      *west = std::min(*west, low.x());
      *east = std::max(*east, high.x());
      return;
    }
    const double x = low.x() + (row - low.y()) / (high.y() - low.y()) * (high.x() - low.x());
    *west = std::min(*west, x);
    *east = std::max(*east, x);
  }
  static int FirstAtLeast(double position, int count) { return static_cast<int>(std::clamp(std::ceil(position), 0.0, double{1} * count)); }
  static int LastAtMost(double position, int count) { return static_cast<int>(std::clamp(std::floor(position), -1.0, count - 1.0)); }

  HeightRaster* raster_;
};

}  // namespace

gis::MapGrid PlanSurfaceGrid(std::span<const MeshTile> tiles, const MapFrame& frame, double resolution_m) {
  SKYQUILT_CHECK(std::isfinite(resolution_m) && resolution_m > 0.0, std::to_string(resolution_m));
  gis::MapGrid grid;
  grid.georeferenced = frame.georeferenced();
  if (grid.georeferenced) grid.zone = frame.zone();
  grid.resolution_m = resolution_m;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const MeshTile& tile : tiles) {
    if (tile.id.level != 0) continue;
    base::ThrowIfCancelled();
    for (const Eigen::Vector3d& position : tile.mesh.position) {
      const Eigen::Vector3d at = frame.MapFromEnu(position);
      if (!at.allFinite()) continue;
      low = low.cwiseMin(at.head<2>());
      high = high.cwiseMax(at.head<2>());
    }
  }
  if (!(low.x() <= high.x())) return grid;
  const auto count = [&](double resolution) {
    return Eigen::Vector2d(std::max(1.0, MultiplesAbove(high.x(), resolution) - MultiplesBelow(low.x(), resolution)),
                           std::max(1.0, MultiplesAbove(high.y(), resolution) - MultiplesBelow(low.y(), resolution)));
  };
  const Eigen::Vector2d cells = count(resolution_m);
  if (cells.prod() > kMostCells) {
    double fits = NiceNumberAbove(1.0001 * resolution_m);
    while (count(fits).prod() > kMostCells) fits = NiceNumberAbove(1.0001 * fits);
    throw base::UsageError(
        fmt::format("maps of the surface with products.resolution_m = {:.6g} would have {:.4g} million cells, more than {:.0f} million; "
                    "set products.resolution_m to at least {:.6g}, or give a smaller area with products.boundary",
                    resolution_m, cells.prod() / 1e6, kMostCells / 1e6, fits));
  }
  grid.width = static_cast<int>(cells.x());
  grid.height = static_cast<int>(cells.y());
  grid.left = MultiplesBelow(low.x(), resolution_m) * resolution_m;
  grid.top = std::max(MultiplesAbove(high.y(), resolution_m), MultiplesBelow(low.y(), resolution_m) + 1.0) * resolution_m;
  return grid;
}

HeightRaster RasteriseSurface(std::span<const MeshTile> tiles, const MapFrame& frame, const gis::MapGrid& grid) {
  HeightRaster raster{grid, std::vector<float>(grid.size(), kNoHeight)};
  if (raster.height_m.empty() || tiles.empty()) return raster;
  base::Progress progress("surface heights", static_cast<double>(tiles.size()), "tiles");
  TrianglePainter painter(&raster);
  std::vector<Eigen::Vector3d> in_cells;
  for (const MeshTile& tile : tiles) {
    base::ThrowIfCancelled();
    progress.Advance();
    if (tile.id.level != 0) continue;
    in_cells.clear();
    in_cells.reserve(tile.mesh.position.size());
    for (const Eigen::Vector3d& position : tile.mesh.position) {
      const Eigen::Vector3d at = frame.MapFromEnu(position);
      const Eigen::Vector2d cell = grid.CellOf(at.head<2>());
      in_cells.emplace_back(cell.x(), cell.y(), at.z());
    }
    for (const Triangle& t : tile.mesh.triangle) {
      SKYQUILT_CHECK(std::max({t[0], t[1], t[2]}) < in_cells.size(), "a triangle without its vertices in tile " + tile.id.Name());
      const std::array<Eigen::Vector3d, 3> corner = {in_cells[t[0]], in_cells[t[1]], in_cells[t[2]]};
      if (corner[0].allFinite() && corner[1].allFinite() && corner[2].allFinite()) painter.Paint(corner);
    }
  }
  progress.Finish();
  return raster;
}

}  // namespace skyquilt::surface
