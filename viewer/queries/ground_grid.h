// Means of values in the cells of a map, and the map as a picture.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace skyquilt::viewer {

class GroundGrid {
 public:
  // Square cells of at least finest_m from min_enu on that cover the box; at most kMaxSide of them along each side.
  GroundGrid(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, double finest_m);
  static constexpr int kMaxSide = 512;

  // Places outside are ignored.
  void Add(const Eigen::Vector2d& place, double value);
  bool Empty() const;
  // The value that this share of the cells does not exceed. Must not be empty.
  double Quantile(double share) const;
  // PNG with alpha, north at the top: a ramp from 0 to `scale`, transparent where nothing was added.
  std::string Picture(double scale) const;

  int width() const { return width_; }
  int height() const { return height_; }
  const Eigen::Vector2d& min_enu() const { return min_enu_; }
  Eigen::Vector2d max_enu() const { return min_enu_ + cell_m_ * Eigen::Vector2d(width_, height_); }

 private:
  Eigen::Vector2d min_enu_;
  double cell_m_;
  int width_, height_;
  std::vector<double> sums_;  // rows from the south
  std::vector<uint32_t> counts_;
};

}  // namespace skyquilt::viewer
