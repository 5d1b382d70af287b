#include "worker/start/point_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/order_statistics.h"

namespace skyquilt::worker {
namespace {

constexpr double kPointsPerCell = 16.0;
constexpr int kMostCells = 256;    // along an axis
constexpr double kStrays = 0.002;  // share of points beyond each side of the grid, so that outliers do not enlarge it

double QuantileOf(const std::vector<survey::SparsePoint>& points, int axis, double share) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const survey::SparsePoint& point : points) values.push_back(point.x_in_enu[axis]);
  return base::NearestRankQuantile(values, share);
}

}  // namespace

scene::HeightMap SurfaceOfPoints(const survey::Survey& survey) {
  if (survey.points.empty()) return {};
  Eigen::Vector2d low, high;
  for (int axis = 0; axis < 2; ++axis) {
    low[axis] = QuantileOf(survey.points, axis, kStrays);
    high[axis] = QuantileOf(survey.points, axis, 1.0 - kStrays);
  }
  const Eigen::Vector2d size = (high - low).cwiseMax(1e-3);
  const double cell_m = std::max(std::sqrt(kPointsPerCell * size.prod() / static_cast<double>(survey.points.size())), size.maxCoeff() / kMostCells);
  const geo::PlaneGrid grid(low, cell_m, size);
  std::vector<std::vector<double>> in_cell(grid.size());
  for (const survey::SparsePoint& point : survey.points) {
    const int64_t cell = grid.CellAt(point.x_in_enu.head<2>());
    if (cell >= 0) in_cell[static_cast<size_t>(cell)].push_back(point.x_in_enu.z());
  }
  std::vector<double> heights(in_cell.size(), 0.0), known(in_cell.size(), 0.0);
  for (size_t i = 0; i < in_cell.size(); ++i) {
    std::vector<double>& z = in_cell[i];
    if (z.empty()) continue;
    heights[i] = base::UpperMedian(z);
    known[i] = 1.0;
  }
  scene::FillFromSurroundings(grid, 1, &heights, std::move(known));
  return {grid, std::move(heights)};
}

}  // namespace skyquilt::worker
