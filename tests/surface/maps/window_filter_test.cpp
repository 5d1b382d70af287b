#include "surface/maps/window_filter.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "surface/maps/height_raster.h"

namespace skyquilt::surface {
namespace {

bool Same(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

float SlowMinimum(const base::Grid<float>& grid, int column, int row, int half) {
  float lowest = kNoHeight;
  for (int r = std::max(0, row - half); r <= std::min(grid.rows - 1, row + half); ++r) {
    for (int c = std::max(0, column - half); c <= std::min(grid.columns - 1, column + half); ++c) {
      const float value = grid.At(c, r);
      if (!std::isnan(value) && !(value >= lowest)) lowest = value;
    }
  }
  return lowest;
}

RC_GTEST_PROP(WindowFilter, IsTheLowestAndHighestInEachWindow, ()) {
  base::Grid<float> grid(*rc::gen::inRange(1, 45), *rc::gen::inRange(1, 25), kNoHeight);
  for (float& value : grid.value) {
    const int random = *rc::gen::inRange(-20, 30);
    value = random > 20 ? kNoHeight : static_cast<float>(random);
  }
  const int half = *rc::gen::inRange(0, 30);
  const base::Grid<float> low = WindowMinimum(grid, half);
  const base::Grid<float> high = WindowMaximum(grid, half);
  base::Grid<float> negative = grid;
  for (float& value : negative.value) value = -value;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      RC_ASSERT(Same(low.At(column, row), SlowMinimum(grid, column, row, half)));
      RC_ASSERT(Same(high.At(column, row), -SlowMinimum(negative, column, row, half)));
    }
  }
  const base::Grid<float> opened = Opening(grid, half);
  const base::Grid<float> closed = Closing(grid, half);
  const base::Grid<float> again = Opening(opened, half);
  for (size_t i = 0; i < grid.value.size(); ++i) {
    RC_ASSERT(std::isnan(grid.value[i]) == std::isnan(opened.value[i]) && std::isnan(grid.value[i]) == std::isnan(closed.value[i]));
    if (std::isnan(grid.value[i])) continue;
    RC_ASSERT(opened.value[i] <= grid.value[i] && closed.value[i] >= grid.value[i]);
    RC_ASSERT(again.value[i] == opened.value[i]);
  }
}

TEST(WindowFilter, NothingStaysNothing) {
  EXPECT_TRUE(WindowMinimum(base::Grid<float>(), 3).value.empty());
  const base::Grid<float> gaps = Opening(base::Grid<float>(4, 3, kNoHeight), 2);
  EXPECT_TRUE(std::all_of(gaps.value.begin(), gaps.value.end(), [](float value) { return std::isnan(value); }));
  EXPECT_EQ(Closing(base::Grid<float>(1, 1, 5.0F), 100).value, std::vector<float>{5.0F});
}

TEST(WindowFilter, OpeningRemovesWhatIsNarrowerThanTheWindow) {
  base::Grid<float> grid(30, 30, 1.0F);
  for (int row = 10; row < 15; ++row) {
    for (int column = 10; column < 25; ++column) grid.value[grid.Index(column, row)] = 9.0F;
  }
  EXPECT_EQ(Opening(grid, 2).At(12, 12), 9.0F);
  EXPECT_EQ(Opening(grid, 3).At(12, 12), 1.0F);
  // A gap beside the object does not hide it from the ground.
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 10; ++column) grid.value[grid.Index(column, row)] = kNoHeight;
  }
  EXPECT_EQ(Opening(grid, 5).At(10, 12), 1.0F);
}

}  // namespace
}  // namespace skyquilt::surface
