#include "partition/block_weights.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numeric>

#include "partition/block_grid.h"

namespace skyquilt::partition {
namespace {

BlockSet Tiled(int rows, int columns, double side, double margin) {
  const BlockGrid grid = SplitByCount({-20.0, 40.0}, {-20.0 + side * columns, 40.0 + side * rows}, rows, columns);
  BlockSet set;
  set.rows = rows;
  set.columns = columns;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      Block block;
      block.id = static_cast<int>(set.blocks.size());
      block.min_enu << grid.Min(row, column), 0.0;
      block.max_enu << grid.Max(row, column), 10.0;
      block.margin_m = margin;
      set.blocks.push_back(block);
    }
  }
  return set;
}

// A position in units of the whole grid, 0..1.
double Fraction() {
  return *rc::gen::inRange(0, 100001) / 100000.0;
}

RC_GTEST_PROP(BlockWeight, RawRampsOfNeighboursSumToOneInside, ()) {
  const int rows = *rc::gen::inRange(1, 5);
  const int columns = *rc::gen::inRange(1, 5);
  const double side = *rc::gen::inRange(1, 1000) * 1.7;
  const double margin = side * *rc::gen::inRange(0, 26) / 100.0;
  const BlockSet set = Tiled(rows, columns, side, margin);
  // At least a margin away from the rim, where the outer ramps have not begun to fall.
  const double x = -20.0 + margin + (side * columns - 2 * margin) * Fraction() * 0.999999;
  const double y = 40.0 + margin + (side * rows - 2 * margin) * Fraction() * 0.999999;
  double sum = 0.0;
  for (const Block& block : set.blocks) {
    const double weight = BlockWeight(block, x, y);
    RC_ASSERT(weight >= 0.0 && weight <= 1.0);
    sum += weight;
  }
  RC_ASSERT(std::abs(sum - 1.0) < 1e-12);
}

RC_GTEST_PROP(BlockWeights, SumToOneWhereverABlockReaches, ()) {
  BlockSet set = Tiled(3, 2, 30.0, 3.0);
  set.blocks[static_cast<size_t>(*rc::gen::inRange(0, 6))].empty = true;
  const double x = -24.0 + 68.0 * Fraction();
  const double y = 36.0 + 98.0 * Fraction();
  bool reached = false;
  for (const Block& block : set.blocks) reached = reached || (!block.empty && BlockWeight(block, x, y) > 0.0);
  const std::vector<double> weights = BlockWeights(set, x, y);
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  RC_ASSERT(weights.size() == set.blocks.size());
  RC_ASSERT(std::abs(sum - (reached ? 1.0 : 0.0)) < 1e-12);
  for (size_t i = 0; i < weights.size(); ++i) RC_ASSERT(!set.blocks[i].empty || weights[i] == 0.0);
}

TEST(BlockWeight, IsWholeInsideAndNothingBeyondTheMargin) {
  const BlockSet set = Tiled(1, 1, 30.0, 3.0);
  const Block& block = set.blocks[0];
  EXPECT_EQ(BlockWeight(block, -5.0, 55.0), 1.0);
  EXPECT_EQ(BlockWeight(block, -17.0, 43.0), 1.0);
  EXPECT_EQ(BlockWeight(block, -23.0, 55.0), 0.0);
  EXPECT_DOUBLE_EQ(BlockWeight(block, -20.0, 55.0), 0.5);
  EXPECT_DOUBLE_EQ(BlockWeight(block, -20.0, 40.0), 0.25);
  EXPECT_EQ(BlockWeight(block, std::nan(""), 55.0), 0.0);
}

}  // namespace
}  // namespace skyquilt::partition
