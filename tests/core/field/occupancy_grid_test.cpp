#include "core/field/occupancy_grid.h"

#include <gtest/gtest.h>

namespace skyquilt::field {
namespace {

TEST(OccupancyGrid, CoversTheBoxWithinItsBudget) {
  const double extent[3] = {1.0, 0.5, 0.1};
  const OccupancyGrid fine = OccupancyGrid::Make(extent, 0.01, 1 << 20);
  EXPECT_EQ(fine.size[0], 100);
  EXPECT_EQ(fine.size[1], 50);
  EXPECT_EQ(fine.size[2], 10);
  const OccupancyGrid bounded = OccupancyGrid::Make(extent, 1e-4, 10000);
  EXPECT_LE(bounded.CellCount(), 10000);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GE(static_cast<double>(bounded.cell) * bounded.size[axis], extent[axis] - 1e-6);
}

TEST(OccupancyGrid, PositionsOutsideUseTheNearestCell) {
  const double extent[3] = {1.0, 1.0, 1.0};
  const OccupancyGrid grid = OccupancyGrid::Make(extent, 0.25, 1000);
  EXPECT_EQ(grid.IndexAt(-3.0F, -1.0F, 0.0F), grid.Index(0, 0, 0));
  EXPECT_EQ(grid.IndexAt(2.0F, 1.0F, 0.3F), grid.Index(3, 3, 1));
}

TEST(OccupancyGrid, RefreshKeepsDenseCellsAndNeverUnseenOnes) {
  const double extent[3] = {1.0, 1.0, 1.0};
  OccupancyGrid grid = OccupancyGrid::Make(extent, 0.5, 1000);
  grid.tau = {0.5F, 0.0F, -1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.001F};
  grid.UpdateOccupied(0.01F);
  EXPECT_TRUE(grid.occupied[0]);
  EXPECT_FALSE(grid.occupied[2]);
  EXPECT_FALSE(grid.occupied[7]);
  grid.Dilate(1);
  for (size_t i = 0; i < 8; ++i) EXPECT_EQ(grid.occupied[i], i != 2);
}

TEST(OccupancyGrid, EmptySamplesFreeACellAndDenseOnesKeepIt) {
  const double extent[3] = {1.0, 1.0, 1.0};
  OccupancyGrid grid = OccupancyGrid::Make(extent, 0.5, 1000);
  grid.tau.assign(8, 0.1F);
  grid.tau[5] = -1.0F;
  for (int i = 0; i < 60; ++i) {
    grid.UpdateTau(0, 0.001F);
    grid.UpdateTau(1, i % 10 == 0 ? 3.0F : 0.0F);  // a thin surface that one sample in ten hits
    grid.UpdateTau(5, 3.0F);
  }
  grid.UpdateOccupied(0.01F);
  EXPECT_FALSE(grid.occupied[0]);
  EXPECT_TRUE(grid.occupied[1]);
  EXPECT_TRUE(grid.occupied[2]) << "not sampled, so unchanged";
  EXPECT_FALSE(grid.occupied[5]) << "cells never seen stay empty";
  EXPECT_FLOAT_EQ(grid.tau[5], -1.0F);
}

TEST(OccupancyGrid, SurfacesRaiseTheirSixNeighbours) {
  const double extent[3] = {1.0, 1.0, 1.0};
  OccupancyGrid grid = OccupancyGrid::Make(extent, 0.2, 1000);
  grid.tau.assign(grid.tau.size(), 0.0F);
  grid.tau[static_cast<size_t>(grid.Index(2, 2, 2))] = 2.0F;
  grid.tau[static_cast<size_t>(grid.Index(0, 4, 4))] = 2.0F;  // at the edge of the grid
  grid.tau[static_cast<size_t>(grid.Index(2, 2, 3))] = -1.0F;
  grid.RaiseNeighbours(0.4F, 0.03F);
  int awake = 0;
  for (const float tau : grid.tau) awake += tau == 0.03F ? 1 : 0;
  EXPECT_EQ(awake, 5 + 3);
  EXPECT_FLOAT_EQ(grid.tau[static_cast<size_t>(grid.Index(3, 2, 2))], 0.03F);
  EXPECT_FLOAT_EQ(grid.tau[static_cast<size_t>(grid.Index(2, 2, 3))], -1.0F);
  EXPECT_FLOAT_EQ(grid.tau[static_cast<size_t>(grid.Index(4, 2, 2))], 0.0F);
}

TEST(OccupancyGrid, DilateReachesExactlyItsDistance) {
  const double extent[3] = {1.0, 1.0, 1.0};
  OccupancyGrid grid = OccupancyGrid::Make(extent, 0.1, 2000);
  std::fill(grid.occupied.begin(), grid.occupied.end(), false);
  grid.occupied[static_cast<size_t>(grid.Index(5, 5, 5))] = true;
  grid.Dilate(2);
  int count = 0;
  for (const bool v : grid.occupied) count += v ? 1 : 0;
  EXPECT_EQ(count, 125);
}

// A wide sample stands for several cells, so it judges only those that no sharp one has been in.
TEST(OccupancyGrid, WideSamplesJudgeWhereSharpOnesDoNot) {
  const double extent[3] = {1.0, 1.0, 1.0};
  OccupancyGrid grid = OccupancyGrid::Make(extent, 0.5, 8);
  std::fill(grid.tau.begin(), grid.tau.end(), 0.1F);
  grid.Observe(1, 0.5F, false);
  EXPECT_EQ(grid.tau[1], 0.5F);
  EXPECT_EQ(grid.judged[1], 0);
  for (int i = 0; i < 60; ++i) grid.Observe(1, 0.0F, false);
  EXPECT_LT(grid.tau[1], 0.01F);
  grid.Observe(2, 0.3F, true);
  grid.Observe(2, 0.9F, false);
  EXPECT_EQ(grid.tau[2], 0.3F);
  grid.Observe(3, 0.05F, false);
  grid.MarkUnsampled(0.1F);
  for (const int64_t crossed : {1, 2, 3}) EXPECT_GE(grid.tau[static_cast<size_t>(crossed)], 0.0F) << crossed;
  EXPECT_LT(grid.tau[4], 0.0F);
}

TEST(OccupancyGrid, ForgetsCellsThatWereNeverSampled) {
  const double extent[3] = {1.0, 1.0, 1.0};
  OccupancyGrid grid = OccupancyGrid::Make(extent, 0.5, 8);
  std::fill(grid.tau.begin(), grid.tau.end(), 0.1F);
  grid.UpdateTau(3, 0.5F);
  grid.UpdateTau(4, 0.0F);
  grid.MarkUnsampled(0.1F);
  for (int64_t i = 0; i < 8; ++i) {
    EXPECT_EQ(grid.tau[static_cast<size_t>(i)] < 0.0F, i != 3 && i != 4) << i;
    EXPECT_EQ(grid.occupied[static_cast<size_t>(i)], i == 3 || i == 4) << i;
  }
}

}  // namespace
}  // namespace skyquilt::field
