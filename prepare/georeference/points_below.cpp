#include "prepare/georeference/points_below.h"

#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"

namespace skyquilt::prepare::georeference {
namespace {

constexpr double kPointsOfCell = 8.0;  // mean
// Cells far from the grid are not counted one by one: numbers stay small enough for whole numbers.
constexpr double kFarthestCell = 1e9;

int64_t CellAlong(double offset_m, double cell_m) {
  return static_cast<int64_t>(std::clamp(std::floor(offset_m / cell_m), -kFarthestCell, kFarthestCell));
}

}  // namespace

PointsBelow::PointsBelow(const std::vector<survey::SparsePoint>& points) {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = low;
  size_t n = 0;
  for (const survey::SparsePoint& point : points) {
    if (!point.x_in_enu.allFinite()) continue;
    low = n == 0 ? point.x_in_enu.head<2>().eval() : low.cwiseMin(point.x_in_enu.head<2>()).eval();
    high = n == 0 ? point.x_in_enu.head<2>().eval() : high.cwiseMax(point.x_in_enu.head<2>()).eval();
    ++n;
  }
  const double cells = std::max(1.0, static_cast<double>(n) / kPointsOfCell);
  const Eigen::Vector2d size = high - low;
  // Points on a line have no area, but as many cells.
  const double cell_m = std::max({std::sqrt(size.prod() / cells), size.maxCoeff() / cells, 1e-6});
  grid_ = geo::PlaneGrid(low, cell_m, size);
  first_.assign(grid_.size() + 1, 0);
  const auto cell_of = [&](const Eigen::Vector3d& x) {
    const Eigen::Vector2d offset = x.head<2>() - low;
    return grid_.Index(static_cast<int>(std::min<int64_t>(CellAlong(offset.x(), cell_m), grid_.columns - 1)),
                       static_cast<int>(std::min<int64_t>(CellAlong(offset.y(), cell_m), grid_.rows - 1)));
  };
  for (const survey::SparsePoint& point : points) {
    if (point.x_in_enu.allFinite()) ++first_[cell_of(point.x_in_enu) + 1];
  }
  for (size_t cell = 0; cell < grid_.size(); ++cell) first_[cell + 1] += first_[cell];
  points_.resize(n);
  std::vector<size_t> next(first_.begin(), first_.end() - 1);
  for (const survey::SparsePoint& point : points) {
    if (point.x_in_enu.allFinite()) points_[next[cell_of(point.x_in_enu)]++] = point.x_in_enu;
  }
}

void PointsBelow::AddCells(const Eigen::Vector3d& place, int64_t first_column, int64_t last_column, int64_t row,
                           std::vector<std::pair<double, double>>* found) const {
  if (row < 0 || row >= grid_.rows) return;
  const int64_t from = std::max<int64_t>(first_column, 0), to = std::min<int64_t>(last_column, grid_.columns - 1);
  if (from > to) return;
  const size_t begin = first_[grid_.Index(static_cast<int>(from), static_cast<int>(row))];
  const size_t end = first_[grid_.Index(static_cast<int>(to), static_cast<int>(row)) + 1];
  for (size_t i = begin; i < end; ++i) {
    const Eigen::Vector3d& x = points_[i];
    if (x.z() < place.z()) found->emplace_back((x - place).head<2>().squaredNorm(), x.z());
  }
}

void PointsBelow::AddRing(const Eigen::Vector3d& place, int64_t column, int64_t row, int64_t ring,
                          std::vector<std::pair<double, double>>* found) const {
  AddCells(place, column - ring, column + ring, row - ring, found);
  if (ring == 0) return;
  AddCells(place, column - ring, column + ring, row + ring, found);
  const int64_t from = std::max<int64_t>(row - ring + 1, 0), to = std::min<int64_t>(row + ring - 1, grid_.rows - 1);
  for (int64_t y = from; y <= to; ++y) {
    AddCells(place, column - ring, column - ring, y, found);
    AddCells(place, column + ring, column + ring, y, found);
  }
}

void PointsBelow::Nearest(const Eigen::Vector3d& place, size_t n, std::vector<std::pair<double, double>>* found) const {
  found->clear();
  if (n == 0 || points_.empty() || !place.allFinite()) return;
  const Eigen::Vector2d offset = place.head<2>() - grid_.origin;
  const int64_t column = CellAlong(offset.x(), grid_.cell_m), row = CellAlong(offset.y(), grid_.cell_m);
  // Rings outside the grid are empty.
  const int64_t nearest = std::max({-column, column - (grid_.columns - 1), -row, row - (grid_.rows - 1), int64_t{0}});
  const int64_t farthest = std::max({column, grid_.columns - 1 - column, row, grid_.rows - 1 - row});
  for (int64_t ring = nearest; ring <= farthest; ++ring) {
    AddRing(place, column, row, ring, found);
    if (found->size() < n) continue;
    base::OrderStatistic(*found, n - 1);
    found->resize(n);
    // Points of later rings are farther away than this, but for rounding.
    const double reached_m = 0.999 * static_cast<double>(ring) * grid_.cell_m;
    if (std::max_element(found->begin(), found->end())->first < reached_m * reached_m) break;
  }
}

}  // namespace skyquilt::prepare::georeference
