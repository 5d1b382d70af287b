// Divides a rectangle on the ground into a regular grid of blocks. ENU metres; rows count from the south, columns from the west.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace skyquilt::partition {

enum class BlockRequestKind { kAuto, kCount, kSize };

struct BlockRequest {
  BlockRequestKind kind = BlockRequestKind::kAuto;
  int rows = 0;  // kCount
  int columns = 0;
  double size_m = 0.0;  // kSize
};

inline constexpr int kMaxBlocks = 65536;

// Reads "auto", "3x2" (rows x columns) or "size:120" (metres). Throws base::UsageError for anything else, and for values that are not positive and
// finite.
BlockRequest ParseBlockRequest(const std::string& text);

// Every edge is stored once, so that neighbouring cells agree on it to the last bit. Both lists ascend.
struct BlockGrid {
  std::vector<double> x_edges;  // columns + 1, metres
  std::vector<double> y_edges;  // rows + 1

  int rows() const { return static_cast<int>(y_edges.size()) - 1; }
  int columns() const { return static_cast<int>(x_edges.size()) - 1; }
  Eigen::Vector2d Min(int row, int column) const { return {x_edges[static_cast<size_t>(column)], y_edges[static_cast<size_t>(row)]}; }
  Eigen::Vector2d Max(int row, int column) const { return {x_edges[static_cast<size_t>(column) + 1], y_edges[static_cast<size_t>(row) + 1]}; }
  // The same for a cell index, row * columns + column.
  Eigen::Vector2d Min(int index) const { return Min(index / columns(), index % columns()); }
  Eigen::Vector2d Max(int index) const { return Max(index / columns(), index % columns()); }
  // Index of the cell that contains the point. Lower edges belong to a cell; the upper edge only to the last cell. -1 outside and for NaN.
  int CellOf(double x, double y) const;
};

// rows x columns equal cells that fill the rectangle exactly.
BlockGrid SplitByCount(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, int rows, int columns);
// As few square cells of size_m as cover the rectangle, centred on it. Throws base::UsageError above kMaxBlocks.
BlockGrid SplitBySize(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, double size_m);

}  // namespace skyquilt::partition
