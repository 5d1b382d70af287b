// Heights of a surface in the cells of a map, and what can be seen along straight lines above it.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/gis/map_grid.h"

namespace skyquilt::products {

// Places are easting, northing (as in gis::MapGrid) and height, in metres: map space, in which a straight line stays straight enough over the few
// hundred metres between a place and a drone. Memory: 4 bytes per cell. All functions may be called from several threads.
class HeightGrid {
 public:
  // heights_m: row-major, grid.width * grid.height, above what map heights are above; NaN: no surface. Throws std::logic_error for another number.
  HeightGrid(const gis::MapGrid& grid, std::vector<float> heights_m);
  const gis::MapGrid& grid() const { return grid_; }
  // Of a cell inside the grid; NaN: no surface.
  float HeightOf(int column, int row) const { return heights_[grid_.Index(column, row)]; }
  // Of all cells, row by row.
  const std::vector<float>& heights() const { return heights_; }
  // Between the four nearest cell centres bilinearly where they show one surface (highest minus lowest at most two cell sizes: up to 63 degrees),
  // else the height of the nearest cell, so that edges of roofs stay steps. NaN without surface there, and more than half a cell outside the grid's
  // outer edge.
  double HeightAt(const Eigen::Vector2d& easting_northing) const;
  // Whether the straight line from a place on the surface to the eye passes above all cells. A cell hides the place when its height is more than
  // slack_m above the line where the line passes nearest to the cell's centre; so a slope that rises towards the eye does not hide itself. Where a
  // slope rises across the line, centres beside it are higher by up to 0.7 cells times its tangent: slack_m and the first 1.5 cells of horizontal
  // way, which are not looked at, make up for that. Cells without surface, and all outside the grid, hide nothing. A place or eye that is not finite
  // is not visible.
  bool IsVisible(const Eigen::Vector3d& place, const Eigen::Vector3d& eye, double slack_m) const;

 private:
  struct Line;
  bool IsHiddenInBlock(const Line& line, int block_column, int block_row, double way, double end) const;

  gis::MapGrid grid_;
  std::vector<float> heights_;
  int block_columns_ = 0;
  int block_rows_ = 0;
  std::vector<float> block_highest_;  // of 16 x 16 cells each, -infinity: no surface
  float highest_ = -std::numeric_limits<float>::infinity();
};

// How far cells may rise above the line of sight from each cell of the surface and not hide it, metres, row-major: a little, and more where the
// surface is rough on all sides, as crowns of trees are, because such heights are not sure. Beside a roof's edge at least one side is plain, so that
// nothing of the roof is let through. The same for any number of threads.
std::vector<float> SightSlack(const HeightGrid& surface, base::ThreadPool& threads);

}  // namespace skyquilt::products
