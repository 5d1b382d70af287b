#include "surface/maps/fill_smoothly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surface/maps/height_raster.h"

namespace skyquilt::surface {
namespace {

TEST(FillSmoothly, PlanesAndValuesStay) {
  base::Grid<float> grid(97, 64, kNoHeight);
  const auto plane = [](int column, int row) { return static_cast<float>(5000.0 + 0.11 * column - 0.07 * row); };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const bool gap = (column > 20 && column < 80 && row > 10 && row < 50) || row > 60;
      if (!gap) grid.value[grid.Index(column, row)] = plane(column, row);
    }
  }
  FillSmoothly(&grid);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) EXPECT_NEAR(grid.At(column, row), plane(column, row), 2e-3);
  }
}

TEST(FillSmoothly, FollowsHarmonicSurfacesThroughGaps) {
  // x^2 - y^2 is harmonic, so the gap must be filled with it.
  base::Grid<float> grid(120, 120, kNoHeight);
  const auto saddle = [](int column, int row) {
    const double x = (column - 60) / 20.0, y = (row - 60) / 20.0;
    return static_cast<float>(x * x - y * y);
  };
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 120; ++column) {
      if (std::abs(column - 60) > 40 || std::abs(row - 60) > 40) grid.value[grid.Index(column, row)] = saddle(column, row);
    }
  }
  FillSmoothly(&grid);
  // The relief of the gap's edge is 8.
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 120; ++column) EXPECT_NEAR(grid.At(column, row), saddle(column, row), 0.25) << column << " " << row;
  }
}

TEST(FillSmoothly, StaysBetweenTheValuesOfALevelEdge) {
  base::Grid<float> grid(50, 30, kNoHeight);
  for (int column = 0; column < 50; ++column) {
    grid.value[grid.Index(column, 0)] = 2.0F;
    grid.value[grid.Index(column, 29)] = 2.0F;
  }
  grid.value[grid.Index(25, 15)] = 3.0F;
  FillSmoothly(&grid);
  for (const float value : grid.value) {
    EXPECT_GE(value, 1.9F);
    EXPECT_LE(value, 3.0F);
  }
  EXPECT_GT(grid.At(26, 15), grid.At(35, 15));
}

TEST(FillSmoothly, NothingOneValueOneCell) {
  base::Grid<float> empty(7, 5, kNoHeight);
  FillSmoothly(&empty);
  EXPECT_TRUE(std::all_of(empty.value.begin(), empty.value.end(), [](float value) { return std::isnan(value); }));
  base::Grid<float> none;
  FillSmoothly(&none);
  base::Grid<float> one(1, 1, kNoHeight);
  FillSmoothly(&one);
  EXPECT_TRUE(std::isnan(one.value[0]));
  base::Grid<float> single(13, 1, kNoHeight);
  single.value[4] = 7.5F;
  FillSmoothly(&single);
  for (const float value : single.value) EXPECT_NEAR(value, 7.5F, 1e-4F);
}

}  // namespace
}  // namespace skyquilt::surface
