// Sparse points sorted into a grid of the ground plan, to find those nearest to the spot below a camera without looking at all of them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/geo/plane_grid.h"
#include "core/survey/survey.h"

namespace skyquilt::prepare::georeference {

// Thread-safe after construction.
class PointsBelow {
 public:
  // Points that are not finite are left out.
  explicit PointsBelow(const std::vector<survey::SparsePoint>& points);

  // The n points (fewer when there are fewer) of lesser height than the place that are nearest to it in plan view, of equally near ones the lowest:
  // squared horizontal distance and height, in any order. ENU metres.
  void Nearest(const Eigen::Vector3d& place, size_t n, std::vector<std::pair<double, double>>* found) const;

 private:
  // Adds the lower points of the cells at this distance from a cell, in cells along the farther axis. Cells outside the grid have none.
  void AddRing(const Eigen::Vector3d& place, int64_t column, int64_t row, int64_t ring, std::vector<std::pair<double, double>>* found) const;
  void AddCells(const Eigen::Vector3d& place, int64_t first_column, int64_t last_column, int64_t row,
                std::vector<std::pair<double, double>>* found) const;

  geo::PlaneGrid grid_;
  std::vector<size_t> first_;  // per cell: its first place in points_; one more at the end
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace skyquilt::prepare::georeference
