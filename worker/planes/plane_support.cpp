#include "worker/planes/plane_support.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace skyquilt::worker {

using Eigen::Vector2d;
using Eigen::Vector3d;

PlaneSupport::PlaneSupport(const Plane& plane, const std::vector<Vector3d>& points, const std::vector<Vector3d>& elsewhere, double cell_m)
    : origin_(plane.point), along_(plane.normal.unitOrthogonal()), across_(plane.normal.cross(along_)) {
  Vector2d high = low_ = On(points.front());
  for (const Vector3d& x : points) {
    low_ = low_.cwiseMin(On(x));
    high = high.cwiseMax(On(x));
  }
  cell_m_ = std::max(cell_m, (high - low_).maxCoeff() / (kMostCells - 7));
  // One square for the neighbours of those with points, one that stays empty so that the search of holes gets around, and a bit for rounding.
  low_ -= Vector2d::Constant(2.5 * cell_m_);
  const auto count = [this](double length) { return static_cast<int>(length / cell_m_) + 4; };
  columns_ = count(high.x() - low_.x());
  rows_ = count(high.y() - low_.y());
  enum : uint8_t { kNothing, kElsewhere, kPoint };
  std::vector<uint8_t> found(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), kNothing);
  for (const Vector3d& x : elsewhere) {
    const int cell = CellOf(x);
    if (cell >= 0) found[static_cast<size_t>(cell)] = kElsewhere;
  }
  for (const Vector3d& x : points) found[static_cast<size_t>(CellOf(x))] = kPoint;
  inside_.assign(found.size(), 0);
  std::vector<int> not_holes = {0};
  for (int cell = 0; cell < columns_ * rows_; ++cell) {
    if (found[static_cast<size_t>(cell)] == kElsewhere) not_holes.push_back(cell);
    if (found[static_cast<size_t>(cell)] != kPoint) continue;
    for (const int first : {cell - columns_ - 1, cell - 1, cell + columns_ - 1})
      for (int next = first; next < first + 3; ++next)
        if (found[static_cast<size_t>(next)] != kElsewhere) inside_[static_cast<size_t>(next)] = 1;
  }
  FillHoles(not_holes);
}

int PlaneSupport::CellOf(const Vector3d& x) const {
  const Vector2d at = (On(x) - low_) / cell_m_;
  if (!(at.minCoeff() >= 0.0 && at.x() < columns_ && at.y() < rows_)) return -1;
  return static_cast<int>(at.y()) * columns_ + static_cast<int>(at.x());
}

void PlaneSupport::FillHoles(const std::vector<int>& not_holes) {
  // What can be reached from these through sides of empty squares is outside, the rest is inside.
  std::vector<uint8_t> outside(inside_.size(), 0);
  std::vector<int> open = not_holes;
  for (const int cell : open) outside[static_cast<size_t>(cell)] = 1;
  while (!open.empty()) {
    const int cell = open.back(), column = cell % columns_, row = cell / columns_;
    open.pop_back();
    const auto reach = [&](int next) {
      const auto i = static_cast<size_t>(next);
      if (inside_[i] != 0 || outside[i] != 0) return;
      outside[i] = 1;
      open.push_back(next);
    };
    if (column > 0) reach(cell - 1);
    if (column + 1 < columns_) reach(cell + 1);
    if (row > 0) reach(cell - columns_);
    if (row + 1 < rows_) reach(cell + columns_);
  }
  for (size_t i = 0; i < inside_.size(); ++i) inside_[i] = outside[i] == 0 ? 1 : 0;
}

bool PlaneSupport::Contains(const Vector3d& x) const {
  const int cell = CellOf(x);
  return cell >= 0 && inside_[static_cast<size_t>(cell)] != 0;
}

void PlaneSupport::ForEachBox(const std::function<void(const Vector3d& min, const Vector3d& max)>& each) const {
  const Vector3d half = 0.5 * cell_m_ * (along_.cwiseAbs() + across_.cwiseAbs());
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const int cell = row * columns_ + column;
      if (inside_[static_cast<size_t>(cell)] == 0) continue;
      const Vector2d middle = low_ + cell_m_ * Vector2d(column + 0.5, row + 0.5);
      const Vector3d x = origin_ + middle.x() * along_ + middle.y() * across_;
      each(x - half, x + half);
    }
  }
}

}  // namespace skyquilt::worker
