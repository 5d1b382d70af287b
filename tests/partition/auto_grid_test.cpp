#include "partition/auto_grid.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

namespace skyquilt::partition {
namespace {

int Blocks(const BlockGrid& grid) {
  return grid.rows() * grid.columns();
}

// A rectangle whose surface needs so many blocks, all of which cost the same.
AutoGridInput Even(double width_m, double height_m, int needed) {
  AutoGridInput input{.min_enu = {10.0, -20.0}, .max_enu = {10.0 + width_m, -20.0 + height_m}};
  input.fits = [needed](const BlockGrid& grid) { return Blocks(grid) >= needed; };
  input.n_blocks = Blocks;
  input.least_share = [](const BlockGrid& grid) { return 1.0 / Blocks(grid); };
  input.training_pixels = 1e9;
  input.pixels_per_block = 1e6;
  return input;
}

TEST(ChooseGrid, TakesAsFewBlocksAsHoldTheSurface) {
  for (const int needed : {1, 4, 9, 25}) {
    const AutoGrid chosen = ChooseGrid(Even(100.0, 100.0, needed));
    EXPECT_EQ(Blocks(chosen.grid), needed);
    EXPECT_EQ(chosen.reason, "as few as hold the surface in their tables");
    EXPECT_EQ(chosen.grid.Min(0), Eigen::Vector2d(10.0, -20.0));
  }
}

TEST(ChooseGrid, NoMoreBlocksThanPixelsCanTrain) {
  AutoGridInput input = Even(300.0, 100.0, 1000);
  input.training_pixels = 7.5e6;
  const AutoGrid chosen = ChooseGrid(input);
  EXPECT_LE(Blocks(chosen.grid), 7);
  EXPECT_GE(Blocks(chosen.grid), 5);
  EXPECT_EQ(chosen.reason, "as many as the photos' 7.5 million pixels can train (1 million a block)");
  input.training_pixels = 10.0;
  EXPECT_EQ(Blocks(ChooseGrid(input).grid), 1);
  // Only blocks with points count: half of them are water.
  input.training_pixels = 7.5e6;
  input.n_blocks = [](const BlockGrid& grid) { return (Blocks(grid) + 1) / 2; };
  EXPECT_GE(Blocks(ChooseGrid(input).grid), 10);
}

TEST(ChooseGrid, NoMoreBlocksThanTimeCanTrain) {
  AutoGridInput input = Even(100.0, 100.0, 1000);
  input.block_steps = 6100.0;
  const AutoGrid chosen = ChooseGrid(input);
  EXPECT_EQ(Blocks(chosen.grid), 4);
  EXPECT_EQ(chosen.reason, "as many as the time budget can train (about 6100 steps in all, 1500 a block)");
  // The square divides into 1, 4, 9 blocks; with time for three it becomes two.
  input.block_steps = 5000.0;
  EXPECT_EQ(Blocks(ChooseGrid(input).grid), 2);
  input.block_steps = 100.0;
  EXPECT_EQ(Blocks(ChooseGrid(input).grid), 1);
}

// Blocks at the border of a survey have a small share of the time.
TEST(ChooseGrid, NoBlockThatItsShareOfTheTimeCannotTrain) {
  AutoGridInput input = Even(100.0, 100.0, 1000);
  input.block_steps = 15000.0;
  EXPECT_EQ(Blocks(ChooseGrid(input).grid), 9);
  input.least_share = [](const BlockGrid& grid) { return Blocks(grid) > 4 ? 0.02 : 0.1; };
  const AutoGrid chosen = ChooseGrid(input);
  EXPECT_EQ(Blocks(chosen.grid), 4);
  EXPECT_NE(chosen.reason.find("of more, the smallest would get fewer than 500"), std::string::npos) << chosen.reason;
  // Without a time limit shares do not matter.
  input.block_steps = std::numeric_limits<double>::infinity();
  EXPECT_GE(Blocks(ChooseGrid(input).grid), 900);
}

TEST(ChooseGrid, EndsAtTheMostBlocksThereMayBe) {
  AutoGridInput input = Even(100.0, 100.0, 1 << 30);
  input.training_pixels = 1e15;
  const AutoGrid chosen = ChooseGrid(input);
  EXPECT_LE(Blocks(chosen.grid), kMaxBlocks);
  EXPECT_GT(Blocks(chosen.grid), kMaxBlocks / 2);
  EXPECT_EQ(chosen.reason, "more than 65536 are not made");
}

RC_GTEST_PROP(ChooseGrid, MoreTimeOrPixelsNeverGiveFewerBlocks, ()) {
  AutoGridInput input = Even(*rc::gen::inRange(1, 1000), *rc::gen::inRange(1, 1000), *rc::gen::inRange(1, 300));
  const double steepness = *rc::gen::inRange(10, 25) * 0.1;
  input.least_share = [steepness](const BlockGrid& grid) { return std::pow(Blocks(grid), -steepness); };
  const double steps = *rc::gen::inRange(0, 300) * 1000.0, more_steps = steps + *rc::gen::inRange(0, 300) * 1000.0;
  input.training_pixels = *rc::gen::inRange(0, 300) * 1e6;
  const int unlimited = Blocks(ChooseGrid(input).grid);
  input.block_steps = more_steps;
  const int more_time = Blocks(ChooseGrid(input).grid);
  input.block_steps = steps;
  const int blocks = Blocks(ChooseGrid(input).grid);
  RC_ASSERT(1 <= blocks && blocks <= more_time && more_time <= unlimited);
  RC_ASSERT(blocks <= std::max(1.0, steps / kBlockSteps) && blocks <= std::max(1.0, 1e-6 * input.training_pixels));
  RC_ASSERT(blocks == 1 || steps * std::pow(blocks, -steepness) >= kFewestSteps);
  input.training_pixels += *rc::gen::inRange(0, 300) * 1e6;
  RC_ASSERT(Blocks(ChooseGrid(input).grid) >= blocks);
}

}  // namespace
}  // namespace skyquilt::partition
