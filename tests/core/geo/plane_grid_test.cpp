#include "core/geo/plane_grid.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::geo {
namespace {

TEST(PlaneGrid, FindsEachCellFromItsCentreAndNothingOutside) {
  const PlaneGrid grid({-3.0, 100.0}, 0.5, 4, 3);
  ASSERT_EQ(grid.size(), 12U);
  for (size_t cell = 0; cell < grid.size(); ++cell) EXPECT_EQ(grid.CellAt(grid.CentreOf(cell)), static_cast<int64_t>(cell));
  EXPECT_EQ(grid.CentreOf(grid.Index(3, 1)), Eigen::Vector2d(-1.25, 100.75));
  EXPECT_EQ(grid.CellAt({-3.0, 100.0}), 0) << "the corner belongs to the cell";
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(-3.01, 100.2), Eigen::Vector2d(-1.0, 100.2), Eigen::Vector2d(-2.0, 99.99),
                                       Eigen::Vector2d(-2.0, 101.5), Eigen::Vector2d(std::nan(""), 100.2)}) {
    EXPECT_EQ(grid.CellAt(place), -1) << place.transpose();
  }
}

TEST(PlaneGrid, CoversASizeAndHasNoCellByItself) {
  const PlaneGrid grid({0.0, 0.0}, 2.0, Eigen::Vector2d(4.0, 5.0));
  EXPECT_EQ(grid.columns, 3);
  EXPECT_EQ(grid.rows, 3);
  EXPECT_EQ(PlaneGrid().CellAt({0.0, 0.0}), -1);
}

}  // namespace
}  // namespace skyquilt::geo
