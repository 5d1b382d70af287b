#include "buildings/candidates/plan_index.h"

#include <cmath>
#include <limits>
#include <string>

#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

constexpr double kMostCells = 50e6;  // a point far away from all others must not cost more memory than they do

}  // namespace

PlanIndex::PlanIndex(const PointCloud& cloud, double cell_m) : cloud_(cloud) {
  SKYQUILT_CHECK(cell_m > 0.0 && cloud.points.size() < std::numeric_limits<uint32_t>::max(), "cell " + std::to_string(cell_m));
  if (cloud.points.empty()) return;
  Eigen::AlignedBox2d box;
  for (size_t i = 0; i < cloud.points.size(); ++i) box.extend(Eigen::Vector2d(cloud.At(i).head<2>()));
  grid_ = geo::PlaneGrid(box.min(), std::max(cell_m, std::sqrt(box.sizes().prod() / kMostCells)), box.sizes());
  first_.assign(grid_.size() + 1, 0);
  const auto cell_of = [&](size_t i) {
    const Eigen::Vector2i cell = CellOf(cloud.At(i).head<2>());
    return grid_.Index(cell.x(), cell.y());
  };
  for (size_t i = 0; i < cloud.points.size(); ++i) ++first_[cell_of(i) + 1];
  for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  index_.resize(cloud.points.size());
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (size_t i = 0; i < cloud.points.size(); ++i) index_[next[cell_of(i)]++] = static_cast<uint32_t>(i);
}

}  // namespace skyquilt::buildings
