// A coarse height map z(x, y) of the ground, known before any field is trained. Survey ENU, metres, double.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "core/geo/plane_grid.h"

namespace skyquilt::scene {

class HeightMap {
 public:
  HeightMap() = default;  // empty
  // heights: [row][column], at cell centres. Throws std::invalid_argument when there are not as many as cells, or cells have no size.
  HeightMap(const geo::PlaneGrid& grid, std::vector<double> heights);

  bool Empty() const { return heights_.empty(); }
  const geo::PlaneGrid& grid() const { return grid_; }
  const std::vector<double>& heights() const { return heights_; }

  // The four cells around a position and their bilinear weights, which sum to 1. Positions outside the grid are clamped to its edge.
  struct Corners {
    std::array<size_t, 4> cell;
    std::array<double, 4> weight;
  };
  Corners Around(double x, double y) const;
  // Height by bilinear interpolation; outside the grid that of its edge. The map must not be empty.
  double At(double x, double y) const;
  // Where a descending ray meets the surface. False for level and rising rays, for rays that start below the surface, and for an empty map.
  bool Intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Eigen::Vector3d* x_in_enu) const;

 private:
  geo::PlaneGrid grid_;
  std::vector<double> heights_;
};

// Fills cells without a value (weight 0) smoothly from their neighbourhood, by averages over coarser and coarser grids (push-pull, Gortler et al.
// 1996). values: [row][column][channel]; weights: [row][column]. Does nothing when no cell has a value.
void FillFromSurroundings(const base::GridShape& shape, int channels, std::vector<double>* values, std::vector<double> weights);

}  // namespace skyquilt::scene
