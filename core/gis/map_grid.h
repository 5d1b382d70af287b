// The cells of a north-up raster on the ground, and the frame they lie in.
#pragma once

#include <Eigen/Core>

#include "core/geo/utm.h"

namespace skyquilt::gis {

// North-up cells, row 0 in the north. With geo-reference in the UTM (or UPS) zone of the survey's origin, otherwise in local metres.
// The outer edges lie on multiples of the resolution, so that maps of one resolution overlay cell by cell.
struct MapGrid {
  bool georeferenced = false;
  geo::UtmZone zone;
  double left = 0.0;  // easting of the outer edge, metres
  double top = 0.0;   // northing of the outer edge
  double resolution_m = 0.0;
  int width = 0;
  int height = 0;

  Eigen::Vector2d CellCentre(double column, double row) const { return {left + (column + 0.5) * resolution_m, top - (row + 0.5) * resolution_m}; }
  Eigen::Vector2d CellOf(const Eigen::Vector2d& easting_northing) const {
    return {(easting_northing.x() - left) / resolution_m - 0.5, (top - easting_northing.y()) / resolution_m - 0.5};
  }
};

}  // namespace skyquilt::gis
