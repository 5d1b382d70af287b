// Finds the points of a cloud by their place seen from above.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "buildings/points/surface_points.h"
#include "core/geo/plane_grid.h"

namespace skyquilt::buildings {

class PlanIndex {
 public:
  // Refers to the cloud.
  PlanIndex(const PointCloud& cloud, double cell_m);

  // Calls use(index) for each point in the box (ENU, borders included), always in the same order.
  template <typename Use>
  void ForEachIn(const Eigen::AlignedBox2d& box, const Use& use) const {
    if (first_.empty() || box.isEmpty()) return;
    const Eigen::Vector2i low = CellOf(box.min()), high = CellOf(box.max());
    for (int row = low.y(); row <= high.y(); ++row) {
      const size_t begin = grid_.Index(low.x(), row), end = grid_.Index(high.x(), row);
      for (uint32_t i = first_[begin]; i < first_[end + 1]; ++i) {
        if (box.contains(Eigen::Vector2d(cloud_.At(index_[i]).head<2>()))) use(index_[i]);
      }
    }
  }

 private:
  // The nearest cell for places outside.
  Eigen::Vector2i CellOf(const Eigen::Vector2d& enu) const {
    const Eigen::Vector2d cell = ((enu - grid_.origin) / grid_.cell_m).array().floor();
    return {static_cast<int>(std::clamp(cell.x(), 0.0, grid_.columns - 1.0)), static_cast<int>(std::clamp(cell.y(), 0.0, grid_.rows - 1.0))};
  }

  const PointCloud& cloud_;
  geo::PlaneGrid grid_;
  std::vector<uint32_t> first_;  // of each cell and of the end, in index_
  std::vector<uint32_t> index_;  // of points, cell by cell
};

}  // namespace skyquilt::buildings
