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

struct Extent {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
};

// Edges of the box are curves on the map, so points along the edges are needed too.
Extent ProjectedExtent(const scene::SceneInfo& info, const MapProjection& projection) {
  constexpr int kSteps = 16;
  Extent extent;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      if (i != 0 && i != kSteps && j != 0 && j != kSteps) continue;
      for (const double z : {info.min_enu.z(), info.max_enu.z()}) {
        const Eigen::Vector3d x(info.min_enu.x() + (info.max_enu.x() - info.min_enu.x()) * i / kSteps,
                                info.min_enu.y() + (info.max_enu.y() - info.min_enu.y()) * j / kSteps, z);
        const Eigen::Vector2d en = projection.EastingNorthing(x);
        extent.low = extent.low.cwiseMin(en);
        extent.high = extent.high.cwiseMax(en);
      }
    }
  }
  return extent;
}

// Width and height in cells; as doubles, because they may be too large for integers before the limit is checked.
Eigen::Array2d CellCounts(const Extent& extent, double resolution_m) {
  return (extent.high.array() / resolution_m).ceil() - (extent.low.array() / resolution_m).floor();
}

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
  const Extent extent = ProjectedExtent(info, MapProjection(info, grid));
  const bool automatic = options.resolution_m <= 0.0;
  const double gsd_m = info.gsd_m > 0.0 ? info.gsd_m : (extent.high - extent.low).maxCoeff() / 1000.0;
  grid.resolution_m = automatic ? NiceResolution(gsd_m) : options.resolution_m;
  const double most = automatic ? options.MostAutomaticCells() : options.max_pixels;
  const double cells = CellCounts(extent, grid.resolution_m).prod();
  if (cells > most) {
    double fits = grid.resolution_m;
    while (CellCounts(extent, fits).prod() > most) fits = NiceResolution(1.6 * fits);
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
  const Eigen::Array2d counts = CellCounts(extent, grid.resolution_m);
  grid.width = std::max(1, static_cast<int>(counts.x()));
  grid.height = std::max(1, static_cast<int>(counts.y()));
  grid.left = std::floor(extent.low.x() / grid.resolution_m) * grid.resolution_m;
  grid.top = std::ceil(extent.high.y() / grid.resolution_m) * grid.resolution_m;
  return grid;
}

MapProjection::MapProjection(const scene::SceneInfo& info, const gis::MapGrid& grid) : grid_(grid) {
  if (!grid.georeferenced) return;
  frame_.emplace(info.origin);
  start_height_m_ = info.origin.height_m;
}

MapProjection::VerticalLine MapProjection::VerticalLineAt(const Eigen::Vector2d& easting_northing) const {
  if (!grid_.georeferenced) return {{easting_northing.x(), easting_northing.y(), 0.0}, {0.0, 0.0, -1.0}};
  // The line is the ellipsoid's normal. Its direction is taken between points 1 km apart, so that rounding is below 1e-9.
  constexpr double kBase_m = 1000.0;
  geo::Geodetic place = geo::GeodeticFromUtm(easting_northing, start_height_m_, grid_.zone);
  const Eigen::Vector3d start = frame_->EnuFromGeodetic(place);
  place.height_m -= kBase_m;
  return {start, (frame_->EnuFromGeodetic(place) - start).normalized()};
}

Eigen::Vector2d MapProjection::EastingNorthing(const Eigen::Vector3d& x_in_enu) const {
  if (!grid_.georeferenced) return x_in_enu.head<2>();
  return geo::UtmFromGeodetic(frame_->GeodeticFromEnu(x_in_enu), grid_.zone);
}

MapRayGenerator::MapRayGenerator(const scene::SceneInfo& info, const gis::MapGrid& grid) : info_(info), grid_(grid), projection_(info, grid) {
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
  const auto node = [&](int j, int i) -> const MapProjection::VerticalLine& {
    return lattice_[static_cast<size_t>(j) * static_cast<size_t>(lattice_columns_) + static_cast<size_t>(i)];
  };
  for (int column = 0; column < grid_.width; ++column) {
    const int i = column / step_;
    const double u = static_cast<double>(column % step_) / step_;
    const auto blend = [&](auto member) -> Eigen::Vector3d {
      return (1 - v) * ((1 - u) * node(node_row, i).*member + u * node(node_row, i + 1).*member) +
             v * ((1 - u) * node(node_row + 1, i).*member + u * node(node_row + 1, i + 1).*member);
    };
    const Eigen::Vector3d start = blend(&MapProjection::VerticalLine::start_enu);
    const Eigen::Vector3d down = blend(&MapProjection::VerticalLine::down_enu).normalized();
    // The point of the line at the middle height of the scene, because over kilometres vertical lines are not parallel to ENU z.
    const double middle_z = 0.5 * (info_.min_enu.z() + info_.max_enu.z());
    const Eigen::Vector3d place = start + down * ((middle_z - start.z()) / down.z());
    // Include cells that the edge of the box crosses.
    const double rim = 0.75 * grid_.resolution_m;
    if ((place.head<2>().array() < info_.min_enu.head<2>().array() - rim).any() ||
        (place.head<2>().array() > info_.max_enu.head<2>().array() + rim).any()) {
      continue;
    }
    // Only the height range of the blocks at this cell, so that the ray does not pass space that no block was trained on.
    double top = -std::numeric_limits<double>::infinity();
    double bottom = std::numeric_limits<double>::infinity();
    for (const scene::SceneBlock& block : info_.blocks) {
      if ((place.head<2>().array() < block.TrainMin().head<2>().array()).any() ||
          (place.head<2>().array() > block.TrainMax().head<2>().array()).any()) {
        continue;
      }
      top = std::max(top, block.max_enu.z());
      bottom = std::min(bottom, block.min_enu.z());
    }
    if (!(top > bottom)) {
      top = info_.max_enu.z();
      bottom = info_.min_enu.z();
    }
    const double s = (top - start.z()) / down.z();
    const double length = (bottom - top) / down.z();
    render::Ray ray;
    ray.origin_enu = start + s * down;
    ray.direction_enu = down;
    ray.t_far = length;
    ray.pixel_width = static_cast<float>(grid_.resolution_m);  // a map cell is a column
    out->rays.push_back(ray);
    out->column.push_back(column);
    out->start_height_m.push_back(projection_.start_height_m() - s);
  }
}

}  // namespace skyquilt::products
