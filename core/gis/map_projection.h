// Converts between map coordinates (UTM, or local x, y without geo-reference) and a survey's ENU frame, and plans maps over a part of that frame.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "core/geo/enu_frame.h"
#include "core/gis/map_grid.h"

namespace skyquilt::gis {

class MapProjection {
 public:
  // origin: of the ENU frame; it has no meaning without geo-reference. Of the grid only zone and georeferenced are read.
  MapProjection(const geo::Geodetic& origin, const MapGrid& grid);

  // Vertical line at a position on the map: the points start + s * down, s in metres. Their height is start_height_m - s, to well below a millimetre.
  struct VerticalLine {
    Eigen::Vector3d start_enu;
    Eigen::Vector3d down_enu;  // length 1; the ellipsoid's inward normal
  };
  double start_height_m() const { return start_height_m_; }  // ellipsoidal, or local z without geo-reference
  VerticalLine VerticalLineAt(const Eigen::Vector2d& easting_northing) const;
  Eigen::Vector2d EastingNorthing(const Eigen::Vector3d& x_in_enu) const;
  // The same and the height, ellipsoidal or local z.
  Eigen::Vector3d MapFromEnu(const Eigen::Vector3d& x_in_enu) const;

 private:
  MapGrid grid_;
  double start_height_m_ = 0.0;
  std::optional<geo::EnuFrame> frame_;
};

// A rectangle on the map, metres.
struct MapExtent {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());

  // Width and height in cells; as doubles, because they may be too large for integers before a limit is checked.
  Eigen::Array2d CellCounts(double resolution_m) const { return (high.array() / resolution_m).ceil() - (low.array() / resolution_m).floor(); }
  // Sets position and size of a grid with this resolution that covers the rectangle.
  void SetCells(double resolution_m, MapGrid* grid) const;
};

// Of a box in the ENU frame.
MapExtent ProjectedExtent(const Eigen::Vector3d& min_enu, const Eigen::Vector3d& max_enu, const MapProjection& projection);

}  // namespace skyquilt::gis
