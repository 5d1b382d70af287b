// The square cells of a grid whose centres lie inside a polygon.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace skyquilt::viewer {

constexpr size_t kMaxPolygonCells = 250'000;

// Positive for corners in counter-clockwise order.
double SignedArea(const std::vector<Eigen::Vector2d>& polygon);
double Perimeter(const std::vector<Eigen::Vector2d>& polygon);
// Of the area. The polygon must have one.
Eigen::Vector2d CentroidOf(const std::vector<Eigen::Vector2d>& polygon);

class PolygonCells {
 public:
  // Cells of at least finest_m, as small as the limit on their number allows; small polygons get finer ones, so that some 400 lie inside.
  PolygonCells(const std::vector<Eigen::Vector2d>& polygon, double finest_m);

  double cell_m() const { return cell_m_; }
  size_t size() const { return size_; }
  Eigen::Vector2d Centre(size_t index) const;
  // Index of the cell to the right, and of the one above (to the north); nothing when it is outside.
  std::optional<size_t> Right(size_t index) const;
  std::optional<size_t> Above(size_t index) const;

 private:
  // Cells of one row without a gap.
  struct Run {
    int64_t row = 0, first_column = 0, columns = 0;
    size_t first_index = 0;
  };
  // False when there are more than the limit.
  bool Fill(const std::vector<Eigen::Vector2d>& polygon);
  const Run& RunOf(size_t index) const;

  double cell_m_ = 0.0;
  Eigen::Vector2d first_centre_ = Eigen::Vector2d::Zero();  // of row 0, column 0
  size_t size_ = 0;
  std::vector<Run> runs_;  // rows from the south, within a row from the west
};

}  // namespace skyquilt::viewer
