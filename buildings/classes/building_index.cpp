#include "buildings/classes/building_index.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/cancel.h"

namespace skyquilt::buildings {
namespace {

constexpr double kSmallestCell_m = 16.0;
constexpr double kMostCells = 1e6;

}  // namespace

BuildingIndex::BuildingIndex(std::span<const Building> buildings, double reach_m, base::ThreadPool& threads) {
  std::vector<std::optional<BuildingShell>> shells(buildings.size());
  threads.ParallelFor(static_cast<int64_t>(buildings.size()), [&](int64_t task, int) {
    base::ThrowIfCancelled();
    shells[static_cast<size_t>(task)].emplace(buildings[static_cast<size_t>(task)], reach_m);
  });
  for (auto& shell : shells) {
    if (!shell->plan_box().isEmpty()) shells_.push_back(std::move(*shell));
  }
  if (shells_.empty()) return;
  for (const BuildingShell& shell : shells_) box_.extend(shell.plan_box());
  cell_m_ = std::max(kSmallestCell_m, std::sqrt(box_.volume() / kMostCells));
  size_ = (box_.sizes().array() / cell_m_).floor().cast<int>() + 1;
  cells_.resize(static_cast<size_t>(size_.x()) * static_cast<size_t>(size_.y()));
  for (uint32_t i = 0; i < shells_.size(); ++i) {
    const Eigen::AlignedBox2d& plan = shells_[i].plan_box();
    const Eigen::Array2i low = ((plan.min() - box_.min()).array() / cell_m_).cast<int>().min(size_ - 1);
    const Eigen::Array2i high = ((plan.max() - box_.min()).array() / cell_m_).cast<int>().min(size_ - 1);
    for (int row = low.y(); row <= high.y(); ++row) {
      for (int column = low.x(); column <= high.x(); ++column)
        cells_[static_cast<size_t>(row) * static_cast<size_t>(size_.x()) + static_cast<size_t>(column)].push_back(i);
    }
  }
}

BuildingIndex::Found BuildingIndex::At(const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal) const {
  Found found;
  const Eigen::Vector2d plan = x_in_enu.head<2>();
  if (!box_.contains(plan)) return found;
  const Eigen::Array2i cell = ((plan - box_.min()).array() / cell_m_).cast<int>().min(size_ - 1);
  for (const uint32_t i : cells_[static_cast<size_t>(cell.y()) * static_cast<size_t>(size_.x()) + static_cast<size_t>(cell.x())]) {
    const BuildingShell& shell = shells_[i];
    if (!shell.plan_box().contains(plan)) continue;
    found.near.Join(shell.At(x_in_enu, normal));
    found.inside_m = std::max(found.inside_m, shell.DepthInside(plan));
  }
  return found;
}

}  // namespace skyquilt::buildings
