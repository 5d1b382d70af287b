// A surface z(x, y) on a coarse grid over the ground plan. Survey ENU, metres, double.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace skyquilt::scene {

class HeightMap {
 public:
  HeightMap() = default;  // empty
  // heights: [row][column], cell centres at min + (index + 0.5) * cell_m; columns east, rows north.
  // Throws std::invalid_argument when their number is not columns * rows or cell_m is not positive.
  HeightMap(double min_x, double min_y, double cell_m, int columns, int rows, std::vector<double> heights);

  bool Empty() const { return heights_.empty(); }
  double min_x() const { return min_x_; }
  double min_y() const { return min_y_; }
  double cell_m() const { return cell_m_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const std::vector<double>& heights() const { return heights_; }

  // The four cells around a place and their bilinear weights, which sum to 1; beyond the grid those of its edge.
  struct Corners {
    std::array<size_t, 4> cell;
    std::array<double, 4> weight;
  };
  Corners Around(double x, double y) const;
  // Bilinear; beyond the grid the height at its edge. Not empty.
  double At(double x, double y) const;
  // Where a ray that goes down meets the surface; false for level and rising rays, below the surface, and when there is none.
  bool Meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Eigen::Vector3d* x_in_enu) const;

 private:
  double min_x_ = 0.0, min_y_ = 0.0, cell_m_ = 1.0;
  int columns_ = 0, rows_ = 0;
  std::vector<double> heights_;
};

// Gives cells without a value (weight 0) one from their surroundings, the nearest first, smoothly: averages over ever coarser grids, then back
// (push-pull, Gortler et al. 1996). values: [row][column][channel]. Leaves them alone when no cell has a value.
void FillFromSurroundings(int columns, int rows, int channels, std::vector<double>* values, std::vector<double> weights);

}  // namespace skyquilt::scene
