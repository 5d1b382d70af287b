// The raster of the map products: which cell lies where on Earth, and which ray looks straight down on it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "core/geo/enu_frame.h"
#include "core/gis/map_grid.h"
#include "core/scene/scene.h"
#include "products/product_options.h"

namespace skyquilt::products {

// The nearest of 1, 2, 5 times a power of ten (nearest as a ratio).
double NiceResolution(double metres);

// A grid over the scene's box. Throws base::UsageError when the requested resolution gives more than options.max_pixels cells (the message
// names a resolution that fits); an automatic one is coarsened instead, with a warning.
gis::MapGrid PlanMapGrid(const scene::SceneInfo& info, const ProductOptions& options);

// Between the grid and the survey's frame.
class MapProjection {
 public:
  MapProjection(const scene::SceneInfo& info, const gis::MapGrid& grid);

  // The plumb line of a place: points enu(s) = start + s * down, whose height is start_height_m - s to well under a millimetre.
  struct PlumbLine {
    Eigen::Vector3d start_enu;
    Eigen::Vector3d down_enu;  // length 1; the ellipsoid's inward normal
  };
  double start_height_m() const { return start_height_m_; }  // ellipsoidal, or local z without geo-reference
  PlumbLine LineAt(const Eigen::Vector2d& easting_northing) const;
  Eigen::Vector2d EastingNorthing(const Eigen::Vector3d& x_in_enu) const;

 private:
  gis::MapGrid grid_;
  double start_height_m_ = 0.0;
  std::optional<geo::EnuFrame> frame_;
};

// One ray per cell of a row that lies in the scene's box; rays start at the top of the boxes above the cell and end below them.
struct MapRays {
  std::vector<render::Ray> rays;
  std::vector<int> column;             // per ray
  std::vector<double> start_height_m;  // height where the ray begins; the surface lies at start_height_m - depth
};

class MapRayMaker {
 public:
  MapRayMaker(const scene::SceneInfo& info, const gis::MapGrid& grid);
  // Replaces the content of `out`. Lines are exact on a lattice of at most 100 m and interpolated between: within a millimetre.
  void MakeRow(int row, MapRays* out) const;

 private:
  const scene::SceneInfo& info_;
  gis::MapGrid grid_;
  MapProjection projection_;
  int step_;  // cells between lattice nodes
  int lattice_columns_;
  std::vector<MapProjection::PlumbLine> lattice_;  // row-major
};

}  // namespace skyquilt::products
