// Finds the blocks above whose ground plans a ray passes, without asking each of them: rectangles sorted into a uniform grid of about as many cells
// as there are blocks. The cost of a ray grows with the cells that it crosses, not with the number of blocks.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "core/base/grid.h"
#include "core/geo/ray_box.h"
#include "core/render/ray.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

// Thread-safe after construction.
class GroundIndex {
 public:
  // The ground plan of a block is the rectangle around its map and its core box widened by the blending ramp. Only these are read, so blocks need not
  // be loaded. Without blocks nothing is found.
  explicit GroundIndex(std::span<const TrainedField* const> blocks);

  // Replaces *found by the numbers of blocks, ascending and each once: all whose ground plan the ray meets, at any height, at a distance in `within`
  // (also those that it only touches), and perhaps some that it passes closely. Nothing where `within` is empty.
  void Find(const Ray& ray, const geo::Interval& within, std::vector<int>* found) const;

  // Where the ray is at heights that some block has. Empty without blocks.
  geo::Interval HeightInterval(const Ray& ray) const { return HeightInterval(ray, min_z_, max_z_); }
  // The same for these heights as well.
  geo::Interval HeightInterval(const Ray& ray, double min_z, double max_z) const;

  // Metres by which rounding may shift positions along the ray near the blocks, many times over.
  double Slack(const Ray& ray) const;

 private:
  // The cell of a coordinate along an axis; the nearest one outside.
  int CellOf(double coordinate, int axis) const;
  size_t Index(const int (&cell)[2]) const { return shape_.Index(cell[0], cell[1]); }

  Eigen::Vector2d low_ = Eigen::Vector2d::Zero(), high_ = Eigen::Vector2d::Zero();  // corners of the rectangle around all ground plans
  double min_z_ = std::numeric_limits<double>::infinity(), max_z_ = -std::numeric_limits<double>::infinity();
  Eigen::Vector2d cell_m_ = Eigen::Vector2d::Ones();
  base::GridShape shape_;
  std::vector<int> first_;  // per cell: its first place in blocks_; one more at the end
  std::vector<int> blocks_;
};

// The part of a that is in b too; empty where there is none.
inline geo::Interval Intersection(const geo::Interval& a, const geo::Interval& b) {
  return {std::max(a.t_near, b.t_near), std::min(a.t_far, b.t_far)};
}

}  // namespace skyquilt::render
