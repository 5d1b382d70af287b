#include "buildings/classes/normal_scatter.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/cancel.h"
#include "core/linear/linear.h"

namespace skyquilt::buildings {
namespace {

constexpr double kCell_m = 1.0;  // three cells across hold all within 1 m
constexpr int64_t kHalfRange = 1 << 20;
constexpr int kBits = 21;
constexpr int64_t kCellsPerTask = 4096;
constexpr int kFewest = 4;

uint64_t KeyOf(int64_t x, int64_t y, int64_t z) {
  const auto part = [](int64_t i) { return static_cast<uint64_t>(std::clamp<int64_t>(i + kHalfRange, 0, 2 * kHalfRange - 1)); };
  return (part(z) << (2 * kBits)) | (part(y) << kBits) | part(x);
}

int64_t PartOf(uint64_t key, int axis) {
  return static_cast<int64_t>((key >> (kBits * axis)) & ((uint64_t{1} << kBits) - 1)) - kHalfRange;
}

struct Cell {
  uint64_t key = 0;
  size_t begin = 0, end = 0;       // of its points in the sorted list
  std::array<double, 6> sum = {};  // xx, yy, zz, xy, xz, yz of its normals
};

// Sums in the order of the points, so that they do not depend on threads.
void Add(const Cell& cell, std::array<double, 6>* sum, size_t* count) {
  for (size_t i = 0; i < 6; ++i) (*sum)[i] += cell.sum[i];
  *count += cell.end - cell.begin;
}

float LeastEigenvalue(const std::array<double, 6>& sum, size_t count) {
  Eigen::Matrix3d mean;
  mean << sum[0], sum[3], sum[4], sum[3], sum[1], sum[5], sum[4], sum[5], sum[2];
  mean /= static_cast<double>(count);
  return static_cast<float>(std::max(0.0, linear::FastSymmetricEigen(mean).values[0]));
}

}  // namespace

std::vector<float> NormalScatter(const PointCloud& cloud, std::span<const uint32_t> chosen, base::ThreadPool& threads) {
  std::vector<std::pair<uint64_t, uint32_t>> order(chosen.size());  // cell, place in `chosen`
  for (uint32_t i = 0; i < chosen.size(); ++i) {
    const Eigen::Array3d cell = (cloud.points[chosen[i]].position.cast<double>().array() / kCell_m).floor();
    order[i] = {KeyOf(static_cast<int64_t>(cell.x()), static_cast<int64_t>(cell.y()), static_cast<int64_t>(cell.z())), i};
  }
  std::sort(order.begin(), order.end());
  std::vector<Cell> cells;
  for (size_t i = 0; i < order.size(); ++i) {
    if (cells.empty() || cells.back().key != order[i].first) cells.push_back({.key = order[i].first, .begin = i});
    Cell& cell = cells.back();
    cell.end = i + 1;
    const Eigen::Vector3d n = cloud.points[chosen[order[i].second]].normal.cast<double>();
    const std::array<double, 6> products = {n.x() * n.x(), n.y() * n.y(), n.z() * n.z(), n.x() * n.y(), n.x() * n.z(), n.y() * n.z()};
    for (size_t k = 0; k < 6; ++k) cell.sum[k] += products[k];
  }

  std::vector<float> scatter(chosen.size(), 0.0F);
  const int64_t n_cells = static_cast<int64_t>(cells.size());
  threads.ParallelFor((n_cells + kCellsPerTask - 1) / kCellsPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t c = task * kCellsPerTask; c < std::min(n_cells, (task + 1) * kCellsPerTask); ++c) {
      const Cell& cell = cells[static_cast<size_t>(c)];
      const int64_t x = PartOf(cell.key, 0), y = PartOf(cell.key, 1), z = PartOf(cell.key, 2);
      std::array<double, 6> sum = {};
      size_t count = 0;
      for (int64_t k = z - 1; k <= z + 1; ++k) {
        for (int64_t j = y - 1; j <= y + 1; ++j) {
          // Neighbours along x follow each other.
          const uint64_t last = KeyOf(x + 1, j, k);
          auto at = std::lower_bound(cells.begin(), cells.end(), KeyOf(x - 1, j, k), [](const Cell& a, uint64_t key) { return a.key < key; });
          for (; at != cells.end() && at->key <= last; ++at) Add(*at, &sum, &count);
        }
      }
      if (count < kFewest) continue;
      const float value = LeastEigenvalue(sum, count);
      for (size_t i = cell.begin; i < cell.end; ++i) scatter[order[i].second] = value;
    }
  });
  return scatter;
}

}  // namespace skyquilt::buildings
