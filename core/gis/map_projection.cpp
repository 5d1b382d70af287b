#include "core/gis/map_projection.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::gis {

MapProjection::MapProjection(const geo::Geodetic& origin, const MapGrid& grid) : grid_(grid) {
  if (!grid.georeferenced) return;
  frame_.emplace(origin);
  start_height_m_ = origin.height_m;
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

Eigen::Vector3d MapProjection::MapFromEnu(const Eigen::Vector3d& x_in_enu) const {
  if (!grid_.georeferenced) return x_in_enu;
  const geo::Geodetic place = frame_->GeodeticFromEnu(x_in_enu);
  const Eigen::Vector2d easting_northing = geo::UtmFromGeodetic(place, grid_.zone);
  return {easting_northing.x(), easting_northing.y(), place.height_m};
}

void MapExtent::SetCells(double resolution_m, MapGrid* grid) const {
  const Eigen::Array2d counts = CellCounts(resolution_m);
  grid->resolution_m = resolution_m;
  grid->width = std::max(1, static_cast<int>(counts.x()));
  grid->height = std::max(1, static_cast<int>(counts.y()));
  grid->left = std::floor(low.x() / resolution_m) * resolution_m;
  grid->top = std::ceil(high.y() / resolution_m) * resolution_m;
}

// Edges of the box are curves on the map, so points along the edges are needed too.
MapExtent ProjectedExtent(const Eigen::Vector3d& min_enu, const Eigen::Vector3d& max_enu, const MapProjection& projection) {
  constexpr int kSteps = 16;
  MapExtent extent;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      if (i != 0 && i != kSteps && j != 0 && j != kSteps) continue;
      for (const double z : {min_enu.z(), max_enu.z()}) {
        const Eigen::Vector3d x(min_enu.x() + (max_enu.x() - min_enu.x()) * i / kSteps, min_enu.y() + (max_enu.y() - min_enu.y()) * j / kSteps, z);
        const Eigen::Vector2d en = projection.EastingNorthing(x);
        extent.low = extent.low.cwiseMin(en);
        extent.high = extent.high.cwiseMax(en);
      }
    }
  }
  return extent;
}

}  // namespace skyquilt::gis
