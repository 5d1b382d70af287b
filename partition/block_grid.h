// A regular grid of blocks over a rectangle in ENU. Rows count from the south, columns from the west.
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

// "auto", "3x2", "size:120". Throws base::UsageError for anything else, zero, negative and non-finite values included.
BlockRequest ParseBlockRequest(const std::string& text);

// Edges are stored once, so that neighbours share them to the last bit. Both are ascending.
struct BlockGrid {
  std::vector<double> x_edges;  // columns + 1, metres
  std::vector<double> y_edges;  // rows + 1

  int rows() const { return static_cast<int>(y_edges.size()) - 1; }
  int columns() const { return static_cast<int>(x_edges.size()) - 1; }
  Eigen::Vector2d Min(int row, int column) const { return {x_edges[static_cast<size_t>(column)], y_edges[static_cast<size_t>(row)]}; }
  Eigen::Vector2d Max(int row, int column) const { return {x_edges[static_cast<size_t>(column) + 1], y_edges[static_cast<size_t>(row) + 1]}; }
  // The same of a cell by its index.
  Eigen::Vector2d Min(int index) const { return Min(index / columns(), index % columns()); }
  Eigen::Vector2d Max(int index) const { return Max(index / columns(), index % columns()); }
  // Index row * columns + column of the one cell that holds the point: cells own their lower edges, the last ones also their upper edge.
  // -1 outside and for NaN.
  int CellOf(double x, double y) const;
};

// rows x columns equal cells that fill the rectangle exactly.
BlockGrid SplitByCount(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, int rows, int columns);
// Square cells of exactly size_m, as few as cover the rectangle, centred on it. Throws base::UsageError above kMaxBlocks.
BlockGrid SplitBySize(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, double size_m);

}  // namespace skyquilt::partition
