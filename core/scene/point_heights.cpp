#include "core/scene/point_heights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"

namespace skyquilt::scene {
namespace {

constexpr double kCellPoints = 4.0;
constexpr int kMostHeightCells = 1024;   // along an axis
constexpr size_t kFewestNeighbours = 5;  // known cells of 3 x 3, itself included, for a median

}  // namespace

HeightMap HeightsOfPoints(const std::vector<Eigen::Vector3d>& points, const Eigen::AlignedBox2d& area) {
  SKYQUILT_CHECK(!points.empty() && !area.isEmpty(), "heights need points and an area");
  const Eigen::Vector2d size = area.sizes().cwiseMax(1e-6);
  const double cell_m = std::max(std::sqrt(kCellPoints * size.prod() / static_cast<double>(points.size())), size.maxCoeff() / kMostHeightCells);
  const geo::PlaneGrid grid(area.min(), cell_m, size);
  std::vector<std::vector<double>> in_cell(grid.size());
  std::vector<double> everywhere;
  for (const Eigen::Vector3d& point : points) {
    everywhere.push_back(point.z());
    const int64_t cell = grid.CellAt(point.head<2>());
    if (cell >= 0) in_cell[static_cast<size_t>(cell)].push_back(point.z());
  }
  // When all points lie beside the area, it is level.
  std::vector<double> medians(in_cell.size(), base::UpperMedian(everywhere)), known(in_cell.size(), 0.0);
  for (size_t i = 0; i < in_cell.size(); ++i) {
    if (in_cell[i].empty()) continue;
    medians[i] = base::UpperMedian(in_cell[i]);
    known[i] = 1.0;
  }
  std::vector<double> heights = medians, around;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (known[grid.Index(column, row)] == 0.0) continue;
      around.clear();
      for (int r = std::max(0, row - 1); r <= std::min(grid.rows - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(grid.columns - 1, column + 1); ++c) {
          if (known[grid.Index(c, r)] != 0.0) around.push_back(medians[grid.Index(c, r)]);
        }
      }
      if (around.size() >= kFewestNeighbours) heights[grid.Index(column, row)] = base::UpperMedian(around);
    }
  }
  FillFromSurroundings(grid, 1, &heights, std::move(known));
  return {grid, std::move(heights)};
}

}  // namespace skyquilt::scene
