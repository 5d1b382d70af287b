// Means of values in the cells of a map, and the map as a picture.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geo/plane_grid.h"

namespace skyquilt::viewer {

class MeanMap {
 public:
  // Square cells of at least finest_m from min_enu on that cover the box; at most kMaxSide of them along each side.
  MeanMap(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, double finest_m);
  static constexpr int kMaxSide = 512;

  // Places outside are ignored.
  void Add(const Eigen::Vector2d& place, double value);
  bool Empty() const;
  // The value that this share of the cells does not exceed. Must not be empty.
  double Quantile(double share) const;
  // PNG with alpha, north at the top: a ramp from 0 to `scale`, transparent where nothing was added.
  std::string Picture(double scale) const;

  const geo::PlaneGrid& grid() const { return grid_; }

 private:
  geo::PlaneGrid grid_;
  std::vector<double> sums_;
  std::vector<uint32_t> counts_;
};

}  // namespace skyquilt::viewer
