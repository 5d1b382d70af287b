#include "products/map_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/errors.h"
#include "core/base/log.h"

namespace skyquilt::products {
namespace {

constexpr double kLatticeSpacing_m = 100.0;
constexpr int kLatticeCells = 32;
constexpr double kMostSurfaceCells = 8e6;  // of the surface that photos are laid on, where it is finer than the scene's detail

}  // namespace

double NiceResolution(double metres) {
  SKYQUILT_CHECK(std::isfinite(metres) && metres > 0.0, std::to_string(metres));
  const double decade = std::pow(10.0, std::floor(std::log10(metres)));
  double best = decade;
  for (const double factor : {2.0, 5.0, 10.0}) {
    if (std::abs(std::log(decade * factor / metres)) < std::abs(std::log(best / metres))) best = decade * factor;
  }
  return best;
}

gis::MapGrid PlanMapGrid(const scene::SceneInfo& info, const ProductOptions& options) {
  options.Check();
  SKYQUILT_CHECK((info.max_enu.array() > info.min_enu.array()).all(), "a scene without extent");
  gis::MapGrid grid;
  grid.georeferenced = info.georeferenced;
  if (info.georeferenced) grid.zone = geo::UtmZoneOf(info.origin);
  const gis::MapExtent extent = gis::ProjectedExtent(info.min_enu, info.max_enu, gis::MapProjection(info.origin, grid));
  const bool automatic = options.resolution_m <= 0.0;
  const double gsd_m = info.gsd_m > 0.0 ? info.gsd_m : (extent.high - extent.low).maxCoeff() / 1000.0;
  grid.resolution_m = automatic ? NiceResolution(gsd_m) : options.resolution_m;
  const double most = automatic ? options.MostAutomaticCells() : options.max_pixels;
  const double cells = extent.CellCounts(grid.resolution_m).prod();
  if (cells > most) {
    double fits = grid.resolution_m;
    while (extent.CellCounts(fits).prod() > most) fits = NiceResolution(1.6 * fits);
    if (!automatic) {
      throw base::UsageError("products.resolution_m = " + std::to_string(grid.resolution_m) + " gives a map of " + std::to_string(cells / 1e6) +
                             " million cells, more than products.max_pixels = " + std::to_string(options.max_pixels / 1e6) +
                             " million; set it to at least " + std::to_string(fits) + " m, or raise products.max_pixels");
    }
    base::LogInfo(
        "maps from the scene are made with {} m per cell, because {} m would give {:.3g} million cells; set products.resolution_m for finer ones",
        fits, grid.resolution_m, cells / 1e6);
    grid.resolution_m = fits;
  }
  extent.SetCells(grid.resolution_m, &grid);
  return grid;
}

gis::MapGrid PlanPhotoSurfaceGrid(const scene::SceneInfo& info, const ProductOptions& options) {
  ProductOptions own = options;
  own.resolution_m = 0.0;
  const gis::MapGrid coarse = PlanMapGrid(info, own);
  own.resolution_m = 4.0 * static_cast<double>(coarse.size()) <= kMostSurfaceCells ? 0.5 * coarse.resolution_m : coarse.resolution_m;
  own.resolution_m = std::max(own.resolution_m, options.resolution_m);
  return PlanMapGrid(info, own);
}

gis::MapGrid PlanHeightGrid(const scene::SceneInfo& info, const ProductOptions& options) {
  const bool stated = options.resolution_m > 0.0;
  return stated && options.ortho_source == "photos" ? PlanPhotoSurfaceGrid(info, options) : PlanMapGrid(info, options);
}

std::optional<RayDown> RayDownFrom(const scene::SceneInfo& info, const gis::MapProjection::VerticalLine& line, double line_start_height_m,
                                   double rim_m, double width_m) {
  const Eigen::Vector3d &start = line.start_enu, &down = line.down_enu;
  // The point of the line at the middle height of the scene, because over kilometres vertical lines are not parallel to ENU z.
  const double middle_z = 0.5 * (info.min_enu.z() + info.max_enu.z());
  const Eigen::Vector3d place = start + down * ((middle_z - start.z()) / down.z());
  if ((place.head<2>().array() < info.min_enu.head<2>().array() - rim_m).any() ||
      (place.head<2>().array() > info.max_enu.head<2>().array() + rim_m).any()) {
    return std::nullopt;
  }
  double top = -std::numeric_limits<double>::infinity();
  double bottom = std::numeric_limits<double>::infinity();
  for (const scene::SceneBlock& block : info.blocks) {
    if ((place.head<2>().array() < block.TrainMin().head<2>().array()).any() ||
        (place.head<2>().array() > block.TrainMax().head<2>().array()).any()) {
      continue;
    }
    top = std::max(top, block.max_enu.z());
    bottom = std::min(bottom, block.min_enu.z());
  }
  if (!(top > bottom)) {
    top = info.max_enu.z();
    bottom = info.min_enu.z();
  }
  const double s = (top - start.z()) / down.z();
  RayDown found;
  found.ray.origin_enu = start + s * down;
  found.ray.direction_enu = down;
  found.ray.t_far = (bottom - top) / down.z();
  found.ray.pixel_width = static_cast<float>(width_m);
  found.start_height_m = line_start_height_m - s;
  return found;
}

MapRayGenerator::MapRayGenerator(const scene::SceneInfo& info, const gis::MapGrid& grid) : info_(info), grid_(grid), projection_(info.origin, grid) {
  step_ = static_cast<int>(std::clamp(std::floor(kLatticeSpacing_m / grid.resolution_m), 1.0, double{kLatticeCells}));
  lattice_columns_ = (grid.width - 1) / step_ + 2;
  const int lattice_rows = (grid.height - 1) / step_ + 2;
  lattice_.reserve(static_cast<size_t>(lattice_columns_) * static_cast<size_t>(lattice_rows));
  for (int j = 0; j < lattice_rows; ++j) {
    for (int i = 0; i < lattice_columns_; ++i)
      lattice_.push_back(projection_.VerticalLineAt(grid.CellCentre(double{1} * i * step_, double{1} * j * step_)));
  }
}

void MapRayGenerator::MakeRow(int row, MapRays* out) const {
  out->rays.clear();
  out->column.clear();
  out->start_height_m.clear();
  const int node_row = row / step_;
  const double v = static_cast<double>(row % step_) / step_;
  const auto node = [&](int j, int i) -> const gis::MapProjection::VerticalLine& {
    return lattice_[static_cast<size_t>(j) * static_cast<size_t>(lattice_columns_) + static_cast<size_t>(i)];
  };
  for (int column = 0; column < grid_.width; ++column) {
    const int i = column / step_;
    const double u = static_cast<double>(column % step_) / step_;
    const auto blend = [&](auto member) -> Eigen::Vector3d {
      return (1 - v) * ((1 - u) * node(node_row, i).*member + u * node(node_row, i + 1).*member) +
             v * ((1 - u) * node(node_row + 1, i).*member + u * node(node_row + 1, i + 1).*member);
    };
    const Eigen::Vector3d start = blend(&gis::MapProjection::VerticalLine::start_enu);
    const Eigen::Vector3d down = blend(&gis::MapProjection::VerticalLine::down_enu).normalized();
    // Cells that the edge of the box crosses are included.
    const std::optional<RayDown> found =
        RayDownFrom(info_, {start, down}, projection_.start_height_m(), 0.75 * grid_.resolution_m, grid_.resolution_m);  // a map cell is a column
    if (!found) continue;
    out->rays.push_back(found->ray);
    out->column.push_back(column);
    out->start_height_m.push_back(found->start_height_m);
  }
}

}  // namespace skyquilt::products
