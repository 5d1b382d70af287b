// Geometry of the maps: the map grid in UTM, and for each cell the ray that looks straight down on it. Over kilometres these rays are not parallel in
// ENU, so they are computed from the ellipsoid's normal.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/gis/map_projection.h"
#include "core/scene/scene.h"
#include "products/product_options.h"

namespace skyquilt::products {

// The nearest value 1, 2 or 5 times a power of ten, by ratio.
double NiceResolution(double metres);

// A map grid that covers the scene's box. An automatic resolution is made coarser, with a line in the log, until the grid has at most
// kMostRenderedCells (and options.max_pixels) cells; a requested one with more than options.max_pixels throws base::UsageError with one that fits.
gis::MapGrid PlanMapGrid(const scene::SceneInfo& info, const ProductOptions& options);

// Grid of the surface that the photos are laid on. Edges of roofs are found between the cells of the scene's detail, so it has cells of half of it,
// unless they are many or products.resolution_m is larger.
gis::MapGrid PlanPhotoSurfaceGrid(const scene::SceneInfo& info, const ProductOptions& options);

// Grid of the maps of heights: cells of products.resolution_m, but where the photos give the orthophoto its detail (products.ortho_source), none
// finer than the surface that they are laid on, as heights come from the scene.
gis::MapGrid PlanHeightGrid(const scene::SceneInfo& info, const ProductOptions& options);

// Rays of one map row, one per cell inside the scene's box. A ray begins at the top of the blocks at this cell and ends at their bottom.
struct MapRays {
  std::vector<render::Ray> rays;
  std::vector<int> column;             // per ray
  std::vector<double> start_height_m;  // height where the ray begins; the surface is at start_height_m - depth
};

// The ray down a vertical line through the scene: from the top of the blocks there to their bottom, so that it does not pass space that no block was
// trained on. line_start_height_m: height of the line's start. rim_m: how far outside the scene's box a line still counts; nothing for lines
// farther out. width_m: of the column that the ray stands for.
struct RayDown {
  render::Ray ray;
  double start_height_m = 0.0;
};
std::optional<RayDown> RayDownFrom(const scene::SceneInfo& info, const gis::MapProjection::VerticalLine& line, double line_start_height_m,
                                   double rim_m, double width_m);

class MapRayGenerator {
 public:
  MapRayGenerator(const scene::SceneInfo& info, const gis::MapGrid& grid);
  // Replaces the content of `out`. Lines are computed exactly on a lattice with at most 100 m spacing and interpolated between, which is correct to a
  // millimetre.
  void MakeRow(int row, MapRays* out) const;

 private:
  const scene::SceneInfo& info_;
  gis::MapGrid grid_;
  gis::MapProjection projection_;
  int step_;  // cells between lattice nodes
  int lattice_columns_;
  std::vector<gis::MapProjection::VerticalLine> lattice_;  // row-major
};

}  // namespace skyquilt::products
