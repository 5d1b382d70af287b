#include "core/scene/height_map.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace skyquilt::scene {
namespace {

// Linear interpolation between two cells of an axis.
struct Along {
  int first = 0, second = 0;
  double share = 0.0;  // weight of the second
};

Along Between(double position, int count) {
  const double t = std::clamp(position - 0.5, 0.0, static_cast<double>(count - 1));
  const int first = std::min(static_cast<int>(t), count - 1);
  return {first, std::min(first + 1, count - 1), t - first};
}

}  // namespace

HeightMap::HeightMap(const geo::PlaneGrid& grid, std::vector<double> heights) : grid_(grid), heights_(std::move(heights)) {
  if (grid.columns < 1 || grid.rows < 1 || !(grid.cell_m > 0.0) || heights_.size() != grid.size()) {
    throw std::invalid_argument("a height map of " + std::to_string(grid.columns) + " x " + std::to_string(grid.rows) + " cells with " +
                                std::to_string(heights_.size()) + " heights");
  }
}

HeightMap::Corners HeightMap::Around(double x, double y) const {
  const Along u = Between((x - grid_.origin.x()) / grid_.cell_m, grid_.columns);
  const Along v = Between((y - grid_.origin.y()) / grid_.cell_m, grid_.rows);
  return {{grid_.Index(u.first, v.first), grid_.Index(u.second, v.first), grid_.Index(u.first, v.second), grid_.Index(u.second, v.second)},
          {(1.0 - v.share) * (1.0 - u.share), (1.0 - v.share) * u.share, v.share * (1.0 - u.share), v.share * u.share}};
}

double HeightMap::At(double x, double y) const {
  const Corners corners = Around(x, y);
  double height = 0.0;
  for (size_t i = 0; i < 4; ++i) height += corners.weight[i] * heights_[corners.cell[i]];
  return height;
}

bool HeightMap::Intersect(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Eigen::Vector3d* x_in_enu) const {
  constexpr double kShallowest = -0.05;  // nearly level rays meet the ground far outside the survey
  constexpr int kRounds = 6;
  if (Empty() || !(direction.z() < kShallowest)) return false;
  double height = At(origin.x(), origin.y());
  for (int round = 0; round < kRounds; ++round) {
    const double t = (height - origin.z()) / direction.z();
    if (!(t > 0.0)) return false;
    *x_in_enu = origin + t * direction;
    const double next = At(x_in_enu->x(), x_in_enu->y());
    if (std::abs(next - height) < 0.05) break;
    height = next;
  }
  return true;
}

void FillFromSurroundings(const base::GridShape& shape, int channels, std::vector<double>* values, std::vector<double> weights) {
  if (shape.columns <= 1 && shape.rows <= 1) return;
  if (std::ranges::none_of(weights, [](double weight) { return weight > 0.0; })) return;
  const base::GridShape half{(shape.columns + 1) / 2, (shape.rows + 1) / 2};
  const auto n = static_cast<size_t>(channels);
  std::vector<double> coarse(half.size() * n, 0.0), coarse_weights(half.size(), 0.0);
  bool all = true;
  for (int row = 0; row < shape.rows; ++row) {
    for (int column = 0; column < shape.columns; ++column) {
      const size_t from = shape.Index(column, row), to = half.Index(column / 2, row / 2);
      all = all && weights[from] > 0.0;
      coarse_weights[to] += weights[from];
      for (size_t c = 0; c < n; ++c) coarse[to * n + c] += weights[from] * (*values)[from * n + c];
    }
  }
  if (all) return;
  for (size_t i = 0; i < coarse_weights.size(); ++i) {
    for (size_t c = 0; c < n && coarse_weights[i] > 0.0; ++c) coarse[i * n + c] /= coarse_weights[i];
    coarse_weights[i] = std::min(coarse_weights[i], 1.0);
  }
  FillFromSurroundings(half, channels, &coarse, std::move(coarse_weights));
  for (int row = 0; row < shape.rows; ++row) {
    const Along v = Between(0.5 * (row + 0.5), half.rows);
    for (int column = 0; column < shape.columns; ++column) {
      const size_t to = shape.Index(column, row);
      const double own = std::min(weights[to], 1.0);
      if (own >= 1.0) continue;
      const Along u = Between(0.5 * (column + 0.5), half.columns);
      for (size_t c = 0; c < n; ++c) {
        const auto at = [&](int r, int s) { return coarse[half.Index(s, r) * n + c]; };
        const double around = (1.0 - v.share) * ((1.0 - u.share) * at(v.first, u.first) + u.share * at(v.first, u.second)) +
                              v.share * ((1.0 - u.share) * at(v.second, u.first) + u.share * at(v.second, u.second));
        (*values)[to * n + c] = own * (*values)[to * n + c] + (1.0 - own) * around;
      }
    }
  }
}

}  // namespace skyquilt::scene
