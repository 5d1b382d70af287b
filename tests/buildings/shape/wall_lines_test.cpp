// The raster of roofs, its edges, and lines on which walls may stand.
#include "buildings/shape/wall_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "buildings/shape/roof_edges.h"
#include "buildings/shape/roof_raster.h"
#include "buildings/shape/wall_cells.h"
#include "tests/buildings/shape/made_candidates.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLinesGsd_m = 0.19;

struct Seen {
  AxisPoints points;
  RoofRaster raster;
  std::array<EdgesAcross, 2> edges;
};
Seen SeenOf(const Shape& truth, const MadePlan& plan = {}) {
  const MadeCandidate made = MakeCandidate(truth, plan);
  Seen seen;
  seen.points = InAxes(made.candidate, made.cloud, truth);
  seen.raster = MakeRoofRaster(seen.points, kLinesGsd_m);
  seen.edges = FindRoofEdges(seen.raster);
  return seen;
}

double LengthOf(const Seen& seen, RoofEdge kind, size_t axis) {
  return seen.raster.cell_m * static_cast<double>(std::count(seen.edges[axis].edge.begin(), seen.edges[axis].edge.end(), kind));
}

TEST(RoofRaster, CoversTheOutlineWithoutGaps) {
  Shape truth = AxesAt(28.0, {-8.0, 8.0}, {-6.0, 6.0});
  truth.parts = {FlatPart(0, 1, 0, 1, 107.0)};
  const RoofRaster raster = SeenOf(truth).raster;
  double area = 0.0;
  for (size_t i = 0; i < raster.covered.size(); ++i) {
    if (raster.covered[i] == 0) {
      EXPECT_TRUE(std::isnan(raster.height[i]));
      continue;
    }
    area += raster.CellArea();
    ASSERT_NEAR(raster.height[i], 107.0F, 0.45F);
  }
  EXPECT_NEAR(area, 192.0, 4.0);
}

TEST(RoofRaster, EmptyWithoutAnOutline) {
  EXPECT_TRUE(MakeRoofRaster({}, kLinesGsd_m).height.empty());
  AxisPoints line;
  line.outline.outer = {{0, 0}, {5, 0}, {9, 0}};
  EXPECT_TRUE(MakeRoofRaster(line, kLinesGsd_m).height.empty());
}

TEST(RoofEdges, RidgesAndSteepRoofsAreNoSteps) {
  for (const double rise : {3.0, 5.0}) {
    Shape truth = AxesAt(15.0, {-8.0, 8.0}, {-5.0, 5.0});
    truth.parts = {PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 105.0, 105.0 + rise)};
    const Seen seen = SeenOf(truth);
    EXPECT_LT(LengthOf(seen, RoofEdge::kStep, 0), 1.0) << rise;
    EXPECT_LT(LengthOf(seen, RoofEdge::kStep, 1), 1.0) << rise;
    // Overhangs included; the staircase of a turned outline adds to both.
    EXPECT_GT(LengthOf(seen, RoofEdge::kOutline, 0), 2.0 * 10.0);
    EXPECT_GT(LengthOf(seen, RoofEdge::kOutline, 1), 2.0 * 16.0);
  }
}

TEST(RoofEdges, AStepIsFoundWhereItIs) {
  Shape truth = AxesAt(70.0, {-8.0, 1.0, 8.0}, {-5.0, 5.0});
  truth.parts = {FlatPart(0, 1, 0, 1, 105.0), FlatPart(1, 2, 0, 1, 106.2)};
  const Seen seen = SeenOf(truth);
  EXPECT_GT(ShareWithEdge(seen.raster, seen.edges[0], 0, 1.0, -4.5, 4.5, 0.4, RoofEdge::kStep), 0.9);
  EXPECT_LT(ShareWithEdge(seen.raster, seen.edges[0], 0, -3.0, -4.5, 4.5, 0.6, RoofEdge::kStep), 0.1);
  EXPECT_LT(ShareWithEdge(seen.raster, seen.edges[1], 1, 0.0, -7.0, 7.0, 0.6), 0.1);
  EXPECT_EQ(ShareWithEdge(seen.raster, seen.edges[0], 0, 1.0, 3.0, 3.0, 0.6), 0.0);
}

TEST(WallLines, OfWallsAndElseOfRoofEdges) {
  Shape truth = AxesAt(50.0, {-8.0, 8.0}, {-5.0, 5.0});
  truth.parts = {PitchedPart(RoofKind::kGable, 0, 1, 0, 1, true, 105.0, 109.0)};
  const Seen seen = SeenOf(truth);
  const WallLines with_walls = FindWallLines(seen.points, seen.raster, seen.edges);
  ASSERT_EQ(with_walls[0].size(), 2U);
  ASSERT_EQ(with_walls[1].size(), 2U);
  EXPECT_NEAR(with_walls[0][0].at, -8.0, 0.1);
  EXPECT_NEAR(with_walls[1][1].at, 5.0, 0.1);
  EXPECT_GT(with_walls[0][0].wall_m2, 20.0);
  EXPECT_GT(with_walls[0][0].edge_m, 8.0);
  AxisPoints roof_only = seen.points;
  roof_only.steep.clear();
  const WallLines without = FindWallLines(roof_only, seen.raster, seen.edges);
  ASSERT_EQ(without[0].size(), 2U);
  EXPECT_NEAR(without[0][0].at, -8.4, 0.2);
  EXPECT_EQ(without[0][0].wall_m2, 0.0);
}

// A chimney and a bush are too little to move the line of a long roof edge.
TEST(WallLines, AFewSteepPointsAreNoWall) {
  Shape truth = AxesAt(0.0, {-10.0, 10.0}, {-7.0, 7.0});
  truth.parts = {FlatPart(0, 1, 0, 1, 106.0)};
  Seen seen = SeenOf(truth, {.wall_share = 0.0});
  seen.points.steep.clear();
  for (int i = 0; i < 36; ++i) seen.points.steep.push_back({{9.3, 0.05 * i, 103.0 + 0.02 * i}, {1.0, 0.0, 0.0}});
  const WallLines lines = FindWallLines(seen.points, seen.raster, seen.edges);
  ASSERT_EQ(lines[0].size(), 2U);
  EXPECT_NEAR(lines[0][1].at, 10.0, 0.25);
}

TEST(CutCells, FollowsTheRoofs) {
  Shape truth = AxesAt(10.0, {-12.0, -2.0, 12.0}, {-10.0, 2.0, 12.0});
  truth.parts = {FlatPart(0, 2, 1, 2, 112.0), FlatPart(0, 1, 0, 1, 112.0)};
  const Seen seen = SeenOf(truth);
  const WallCells cells = CutCells(FindWallLines(seen.points, seen.raster, seen.edges), seen.points, seen.raster, seen.edges);
  double area = 0.0;
  for (int row = 0; row < cells.Rows(); ++row) {
    for (int column = 0; column < cells.Columns(); ++column) area += cells.inside[cells.Index(column, row)] != 0 ? cells.AreaOf(column, row) : 0.0;
  }
  EXPECT_NEAR(area, 360.0, 8.0);
}

}  // namespace
}  // namespace skyquilt::buildings
