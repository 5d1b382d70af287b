#include "buildings/classes/building_shell.h"

#include <algorithm>
#include <utility>

#include "buildings/geometry/polygon.h"

namespace skyquilt::buildings {
namespace {

constexpr double kSmallestShellCell_m = 1.0;
constexpr double kMostShellCells = 4096.0;
constexpr double kUpwards = 0.5;  // normals with a greater z look up

}  // namespace

void NearModel::Join(const NearModel& other) {
  edge_m = std::min(edge_m, other.edge_m);
  corner_m = std::min(corner_m, other.corner_m);
  agreement = std::max(agreement, other.agreement);
  if (other.mismatch < mismatch) {
    mismatch = other.mismatch;
    kind = other.kind;
  }
}

BuildingShell::BuildingShell(const Building& building, double reach_m) : building_(building), reach_m_(reach_m), parts_(PartsOf(building)) {
  edges_begin_ = static_cast<uint32_t>(parts_.faces.size());
  corners_begin_ = edges_begin_ + static_cast<uint32_t>(parts_.edges.size());
  items_ = corners_begin_ + static_cast<uint32_t>(parts_.corners.size());
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(reach_m);
  for (uint32_t item = 0; item < items_; ++item) box_.extend(BoxOf(item));
  if (!box_.isEmpty()) {
    box_ = {box_.min() - margin, box_.max() + margin};
    plan_box_ = {box_.min().head<2>(), box_.max().head<2>()};
    FillCells();
  }
  for (const Eigen::Vector2d& x : building.footprint.outer) plan_box_.extend(x);
}

Eigen::AlignedBox3d BuildingShell::BoxOf(uint32_t item) const {
  Eigen::AlignedBox3d box;
  if (item < edges_begin_) {
    for (const Eigen::Vector3d& x : parts_.faces[item].polygon.rings()[0]) box.extend(x);
  } else if (item < corners_begin_) {
    box.extend(parts_.edges[item - edges_begin_].a);
    box.extend(parts_.edges[item - edges_begin_].b);
  } else {
    box.extend(parts_.corners[item - corners_begin_].place);
  }
  return box;
}

double BuildingShell::Distance(uint32_t item, const Eigen::Vector3d& x, double reach) const {
  if (item < edges_begin_) return parts_.faces[item].polygon.Distance(x, reach);
  if (item < corners_begin_) return DistanceToSegment(x, parts_.edges[item - edges_begin_].a, parts_.edges[item - edges_begin_].b);
  return (x - parts_.corners[item - corners_begin_].place).norm();
}

void BuildingShell::FillCells() {
  const Eigen::Vector3d extent = box_.sizes();
  cell_m_ = std::max({kSmallestShellCell_m, reach_m_, std::cbrt(extent.prod() / kMostShellCells)});
  size_ = (extent.array() / cell_m_).floor().cast<int>() + 1;
  const double far = reach_m_ + 0.5 * std::sqrt(3.0) * cell_m_;  // from the middle of a cell
  std::vector<std::pair<uint32_t, uint32_t>> pairs;              // cell, item
  for (uint32_t item = 0; item < items_; ++item) {
    const Eigen::AlignedBox3d box = BoxOf(item);
    const auto cell_at = [&](const Eigen::Vector3d& x) -> Eigen::Array3i {
      return ((x - box_.min()).array() / cell_m_).floor().cast<int>().max(0).min(size_ - 1);
    };
    const Eigen::Array3i low = cell_at(box.min() - Eigen::Vector3d::Constant(reach_m_));
    const Eigen::Array3i high = cell_at(box.max() + Eigen::Vector3d::Constant(reach_m_));
    for (int k = low.z(); k <= high.z(); ++k) {
      for (int j = low.y(); j <= high.y(); ++j) {
        for (int i = low.x(); i <= high.x(); ++i) {
          const Eigen::Vector3d middle = box_.min() + cell_m_ * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
          if (Distance(item, middle, far) <= far) pairs.emplace_back(static_cast<uint32_t>((k * size_.y() + j) * size_.x() + i), item);
        }
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  begin_.assign(static_cast<size_t>(size_.prod()) + 1, 0);
  for (const auto& [cell, item] : pairs) {
    ++begin_[cell + 1];
    cell_items_.push_back(item);
  }
  for (size_t cell = 1; cell < begin_.size(); ++cell) begin_[cell] += begin_[cell - 1];
}

NearModel BuildingShell::At(const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal) const {
  NearModel near;
  if (box_.isEmpty()) return near;
  // On a slope the walls go on down to the ground, the model ends at one height.
  const Eigen::Vector3d x(x_in_enu.x(), x_in_enu.y(), std::max(x_in_enu.z(), building_.shape.ground_z));
  if (!box_.contains(x)) return near;
  const Eigen::Array3i cell = ((x - box_.min()).array() / cell_m_).cast<int>().min(size_ - 1);
  const auto index = static_cast<size_t>((cell.z() * size_.y() + cell.y()) * size_.x() + cell.x());
  const bool upwards = normal.z() > kUpwards;
  for (uint32_t n = begin_[index]; n < begin_[index + 1]; ++n) {
    const uint32_t item = cell_items_[n];
    const double distance = Distance(item, x, reach_m_);
    if (!(distance <= reach_m_)) continue;
    if (item < edges_begin_) {
      const ModelFace& face = parts_.faces[item];
      const double cosine = face.polygon.normal().dot(normal);
      near.Join({.mismatch = distance / reach_m_ + 1.0 - cosine, .kind = face.kind, .agreement = cosine});
    } else if (item < corners_begin_) {
      if (!(upwards && parts_.edges[item - edges_begin_].below_roof)) near.edge_m = std::min(near.edge_m, distance);
    } else if (!(upwards && parts_.corners[item - corners_begin_].below_roof)) {
      near.corner_m = std::min(near.corner_m, distance);
    }
  }
  return near;
}

double BuildingShell::DepthInside(const Eigen::Vector2d& enu) const {
  if (building_.footprint.outer.size() < 3 || !Contains(building_.footprint, enu)) return 0.0;
  return DistanceToBorder(building_.footprint, enu);
}

}  // namespace skyquilt::buildings
