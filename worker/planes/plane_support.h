// The part of a plane that its points speak for: squares of the plane with points in them, those next to these, and the holes that they surround.
// Holes belong to it because surfaces without texture have points at their edges only. Where points show that the surface is elsewhere, as at a
// chimney, squares without points of the plane and holes do not belong to it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "worker/planes/plane_fit.h"

namespace skyquilt::worker {

// Any frame, metres. Constant after construction.
class PlaneSupport {
 public:
  // At least one point. cell_m: edge of a square, about the spacing of the points; made larger where squares would be more than kMostCells on a side.
  // elsewhere: points that show that the surface is not in the plane.
  PlaneSupport(const Plane& plane, const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& elsewhere, double cell_m);

  // Whether the foot of the perpendicular from x lies in it.
  bool Contains(const Eigen::Vector3d& x) const;
  // The smallest upright box around each square.
  void ForEachBox(const std::function<void(const Eigen::Vector3d& min, const Eigen::Vector3d& max)>& each) const;

  static constexpr int kMostCells = 256;

 private:
  Eigen::Vector2d On(const Eigen::Vector3d& x) const { return {along_.dot(x - origin_), across_.dot(x - origin_)}; }
  // Row * columns_ + column of a square, or -1 outside the grid.
  int CellOf(const Eigen::Vector3d& x) const;
  void FillHoles(const std::vector<int>& not_holes);

  Eigen::Vector3d origin_, along_, across_;
  Eigen::Vector2d low_;
  double cell_m_ = 0.0;
  int columns_ = 0, rows_ = 0;
  std::vector<uint8_t> inside_;  // row by row; the outermost squares are outside
};

}  // namespace skyquilt::worker
