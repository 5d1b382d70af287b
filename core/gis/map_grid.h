// The cells of a map raster and their position on the ground.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "core/geo/utm.h"

namespace skyquilt::gis {

// North-up, row 0 in the north. Coordinates are in the UTM (or UPS) zone of the survey's origin when the survey is geo-referenced, otherwise in local
// metres. The outer edges are multiples of the resolution, so that the cells of maps with the same resolution coincide.
struct MapGrid {
  bool georeferenced = false;
  geo::UtmZone zone;
  double left = 0.0;  // easting of the western outer edge, metres
  double top = 0.0;   // northing of the northern outer edge, metres
  double resolution_m = 0.0;
  int width = 0;
  int height = 0;

  size_t size() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  size_t Index(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column); }
  // Easting and northing of a cell's centre.
  Eigen::Vector2d CellCentre(double column, double row) const { return {left + (column + 0.5) * resolution_m, top - (row + 0.5) * resolution_m}; }
  // Column and row of a position; whole numbers at cell centres.
  Eigen::Vector2d CellOf(const Eigen::Vector2d& easting_northing) const {
    return {(easting_northing.x() - left) / resolution_m - 0.5, (top - easting_northing.y()) / resolution_m - 0.5};
  }
};

}  // namespace skyquilt::gis
