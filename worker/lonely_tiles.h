// Tiles whose ground no second training photo sees. A single photo says nothing about depth: fine detail learned from it hangs somewhere along
// its rays and comes out as shards from any other place. The context learns such tiles' coarse colours only.
#pragma once

#include <vector>

#include "core/survey/survey.h"
#include "worker/ray_source.h"

namespace skyquilt::worker {

// Median heights of the sparse points on a coarse grid, extended to everywhere from the nearest cells.
class PointHeights {
 public:
  explicit PointHeights(const survey::Survey& survey);
  bool Empty() const { return heights_.empty(); }
  double At(double x, double y) const;
  // Where a ray that goes down meets the heights; false when it does not within a few rounds or there are no points.
  bool Meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Eigen::Vector3d* x_in_enu) const;

 private:
  int columns_ = 0, rows_ = 0;
  double cell_m_ = 1.0, min_x_ = 0.0, min_y_ = 0.0;
  std::vector<double> heights_;
};

// Those among the photos' tiles, training photos only. Empty without sparse points.
std::vector<Tile> LonelyTiles(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos);

}  // namespace skyquilt::worker
