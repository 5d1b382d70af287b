#include "partition/block_grid.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/errors.h"

namespace skyquilt::partition {
namespace {

TEST(BlockRequest, ReadsAllThreeForms) {
  EXPECT_EQ(ParseBlockRequest("auto").kind, BlockRequestKind::kAuto);
  EXPECT_EQ(ParseBlockRequest("3x2").rows, 3);
  EXPECT_EQ(ParseBlockRequest("3x2").columns, 2);
  EXPECT_DOUBLE_EQ(ParseBlockRequest("size:12.5").size_m, 12.5);
}

TEST(BlockRequest, RefusesNonsense) {
  for (const char* text : {"",      "0x2",   "2x0",    "-1x2",    "2x-2",     "2x",       "x2",      "2",           "axb",  "2x2x2",
                           "1.5x2", "size:", "size:0", "size:-5", "size:nan", "size:inf", "size:5m", "99999x99999", " 2x2", "nanxnan"}) {
    EXPECT_THROW(ParseBlockRequest(text), base::UsageError) << text;
  }
}

RC_GTEST_PROP(BlockGrid, EveryPointLiesInExactlyOneCore, ()) {
  const int rows = *rc::gen::inRange(1, 9);
  const int columns = *rc::gen::inRange(1, 9);
  const double extent = std::pow(10.0, *rc::gen::inRange(0, 6));
  const double origin = *rc::gen::inRange(-100000, 100000) * 0.37;
  const Eigen::Vector2d low(origin, -0.3 * origin);
  const Eigen::Vector2d high = low + Eigen::Vector2d(extent, 0.7 * extent);
  const BlockGrid grid = SplitByCount(low, high, rows, columns);
  // With steps of a twelfth of a cell, many of the points are exactly on edges.
  const int i = *rc::gen::inRange(0, 12 * columns + 1);
  const int j = *rc::gen::inRange(0, 12 * rows + 1);
  const double x = std::min(high.x(), low.x() + (high.x() - low.x()) * i / (12 * columns));
  const double y = std::min(high.y(), low.y() + (high.y() - low.y()) * j / (12 * rows));
  int holders = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d cell_low = grid.Min(row, column);
      const Eigen::Vector2d cell_high = grid.Max(row, column);
      const bool in_x = x >= cell_low.x() && (x < cell_high.x() || (column == columns - 1 && x <= cell_high.x()));
      const bool in_y = y >= cell_low.y() && (y < cell_high.y() || (row == rows - 1 && y <= cell_high.y()));
      if (!in_x || !in_y) continue;
      ++holders;
      RC_ASSERT(grid.CellOf(x, y) == row * columns + column);
    }
  }
  RC_ASSERT(holders == 1);
}

TEST(BlockGrid, HasNoCellOutside) {
  const BlockGrid grid = SplitByCount({0, 0}, {10, 10}, 2, 2);
  EXPECT_EQ(grid.CellOf(-1e-9, 5), -1);
  EXPECT_EQ(grid.CellOf(5, 10.0001), -1);
  EXPECT_EQ(grid.CellOf(std::numeric_limits<double>::quiet_NaN(), 5), -1);
}

RC_GTEST_PROP(BlockGrid, SquareCellsOfTheGivenSizeCoverTheArea, ()) {
  const double size = *rc::gen::inRange(6, 400) * 0.5;
  const Eigen::Vector2d low(-33.0, 12.0);
  const Eigen::Vector2d high = low + Eigen::Vector2d(*rc::gen::inRange(1, 500), *rc::gen::inRange(1, 500));
  const BlockGrid grid = SplitBySize(low, high, size);
  RC_ASSERT(grid.x_edges.front() <= low.x() + 1e-6);
  RC_ASSERT(grid.x_edges.back() >= high.x() - 1e-6);
  RC_ASSERT(grid.y_edges.front() <= low.y() + 1e-6);
  RC_ASSERT(grid.y_edges.back() >= high.y() - 1e-6);
  RC_ASSERT(grid.x_edges.back() - grid.x_edges.front() < high.x() - low.x() + size);
  for (size_t i = 0; i + 1 < grid.x_edges.size(); ++i) RC_ASSERT(std::abs(grid.x_edges[i + 1] - grid.x_edges[i] - size) < 1e-9);
}

TEST(BlockGrid, RefusesMillionsOfBlocks) {
  EXPECT_THROW(SplitBySize({0, 0}, {1e5, 1e5}, 1.0), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::partition
