#include "products/photo_map/height_grid.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "core/base/random.h"

namespace skyquilt::products {
namespace {

constexpr double kNoSurface = std::numeric_limits<double>::quiet_NaN();

gis::MapGrid GridOf(int width, int height, double resolution_m) {
  gis::MapGrid grid;
  grid.left = 500000.0;
  grid.top = 5600000.0;
  grid.resolution_m = resolution_m;
  grid.width = width;
  grid.height = height;
  return grid;
}

HeightGrid Heights(const gis::MapGrid& grid, const std::function<double(int column, int row)>& height_of) {
  std::vector<float> heights;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) heights.push_back(static_cast<float>(height_of(column, row)));
  }
  return HeightGrid(grid, std::move(heights));
}

// A position in cells from the north-western corner.
Eigen::Vector3d AtCells(const gis::MapGrid& grid, double x, double y, double height) {
  return {grid.left + x * grid.resolution_m, grid.top - y * grid.resolution_m, height};
}

double AnyReal(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1000003) / 1000003.0;
}

// Way along which the line from (x, y) in direction (ux, uy) is in a cell made larger by `more` on all sides; first > second: never.
std::pair<double, double> WayInCell(double x, double y, double ux, double uy, int column, int row, double more) {
  double first = -1e9;
  double second = 1e9;
  for (const auto& [at, direction, cell] : {std::tuple(x, ux, column), std::tuple(y, uy, row)}) {
    const double a = (cell - more - at) / direction;
    const double b = (cell + 1.0 + more - at) / direction;
    first = std::max(first, std::min(a, b));
    second = std::min(second, std::max(a, b));
  }
  return {first, second};
}

// What IsVisible promises, cell by cell. more: see above.
bool IsHiddenByAnyCell(const HeightGrid& heights, const Eigen::Vector3d& place, const Eigen::Vector3d& eye, double slack_m, double more) {
  const gis::MapGrid& grid = heights.grid();
  const double x = (place.x() - grid.left) / grid.resolution_m;
  const double y = (grid.top - place.y()) / grid.resolution_m;
  const double dx = (eye.x() - place.x()) / grid.resolution_m;
  const double dy = (place.y() - eye.y()) / grid.resolution_m;
  const double length = std::hypot(dx, dy);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      auto [first, second] = WayInCell(x, y, dx / length, dy / length, column, row, more);
      first = std::max(first, 1.5 - more);
      second = std::min(second, length + more);
      if (first >= second) continue;
      const double centre = ((column + 0.5 - x) * dx + (row + 0.5 - y) * dy) / length;
      const double line_m = place.z() + slack_m + (eye.z() - place.z()) * centre / length;
      if (static_cast<double>(heights.HeightOf(column, row)) > line_m - more) return true;
    }
  }
  return false;
}

TEST(HeightGrid, InterpolatesWithinOneSurface) {
  const gis::MapGrid grid = GridOf(8, 6, 0.5);
  const HeightGrid plane = Heights(grid, [](int column, int row) { return 100.0 + 0.3 * column - 0.1 * row; });
  EXPECT_EQ(plane.HeightOf(2, 1), 100.5F);
  EXPECT_NEAR(plane.HeightAt(grid.CellCentre(2, 1)), 100.5, 1e-5);
  EXPECT_NEAR(plane.HeightAt(grid.CellCentre(2.25, 1.5)), 100.525, 1e-5);
  // Outside the centres as on the rim, half a cell outside the edge too.
  EXPECT_NEAR(plane.HeightAt(grid.CellCentre(-0.9, 2.0)), 99.8, 1e-5);
  EXPECT_NEAR(plane.HeightAt(grid.CellCentre(7.9, 5.9)), 101.6, 1e-5);
  EXPECT_TRUE(std::isnan(plane.HeightAt(grid.CellCentre(-1.1, 2.0))));
  EXPECT_TRUE(std::isnan(plane.HeightAt(grid.CellCentre(2.0, 6.1))));
  EXPECT_TRUE(std::isnan(plane.HeightAt({std::nan(""), grid.top})));
}

TEST(HeightGrid, KeepsStepsAndHoles) {
  const gis::MapGrid grid = GridOf(8, 6, 0.5);
  const HeightGrid roof = Heights(grid, [](int column, int row) { return column == 7 && row == 5 ? kNoSurface : column < 4 ? 110.0 : 100.0; });
  EXPECT_NEAR(roof.HeightAt(grid.CellCentre(3.4, 2.0)), 110.0, 1e-5);
  EXPECT_NEAR(roof.HeightAt(grid.CellCentre(3.6, 2.0)), 100.0, 1e-5);
  EXPECT_NEAR(roof.HeightAt(grid.CellCentre(6.4, 4.6)), 100.0, 1e-5);
  EXPECT_TRUE(std::isnan(roof.HeightAt(grid.CellCentre(6.6, 4.6))));
  EXPECT_THROW(HeightGrid(grid, std::vector<float>(47)), std::logic_error);
}

RC_GTEST_PROP(HeightGrid, SeesAllOfFlatGround, ()) {
  const gis::MapGrid grid = GridOf(*rc::gen::inRange(1, 60), *rc::gen::inRange(1, 60), 0.2);
  const HeightGrid ground = Heights(grid, [](int, int) { return 31.5; });
  const Eigen::Vector3d place = AtCells(grid, AnyReal(0.0, grid.width), AnyReal(0.0, grid.height), 31.5);
  const Eigen::Vector3d eye = AtCells(grid, AnyReal(-200.0, 200.0), AnyReal(-200.0, 200.0), AnyReal(31.6, 80.0));
  RC_ASSERT(ground.IsVisible(place, eye, 0.0));
}

RC_GTEST_PROP(HeightGrid, HidesWhatIsBehindAWall, ()) {
  // A wall 10 m high along the columns 60 and 61; eyes are west of it.
  const double resolution_m = 0.5;
  const gis::MapGrid grid = GridOf(150, 90, resolution_m);
  const HeightGrid heights = Heights(grid, [](int column, int) { return column == 60 || column == 61 ? 10.0 : 0.0; });
  const double eye_x = AnyReal(-60.0, 50.0);
  const double eye_z = AnyReal(20.0, 90.0);
  const Eigen::Vector3d eye = AtCells(grid, eye_x, AnyReal(0.0, 90.0), eye_z);
  const double shadow = (62.0 * eye_z - 10.0 * eye_x) / (eye_z - 10.0);  // to where it reaches, in cells
  for (const double x : {64.5, shadow - 2.0, shadow + 2.0, 149.5}) {
    if (x < 64.5 || x > 149.5) continue;
    const bool visible = heights.IsVisible(AtCells(grid, x, AnyReal(0.0, 90.0), 0.0), eye, 0.0);
    if (x <= shadow - 2.0) RC_ASSERT(!visible);
    if (x >= shadow + 2.0) RC_ASSERT(visible);
  }
  RC_ASSERT(heights.IsVisible(AtCells(grid, AnyReal(0.0, 60.0), AnyReal(0.0, 90.0), 0.0), AtCells(grid, -90.0, AnyReal(0.0, 90.0), eye_z), 0.0));
  RC_ASSERT(heights.IsVisible(AtCells(grid, AnyReal(60.0, 62.0), AnyReal(0.0, 90.0), 10.0), eye, 0.0));
}

RC_GTEST_PROP(HeightGrid, SeesASlopeFromAbove, ()) {
  // 60 degrees in any direction; the eye is somewhere above the slope, or nearly so that the line of sight runs along it.
  const gis::MapGrid grid = GridOf(60, 60, 0.2);
  const double angle = AnyReal(0.0, 6.283);
  const double slope = std::sqrt(3.0) * grid.resolution_m;  // per cell
  const auto plane = [&](double x, double y) { return 200.0 + slope * ((x - 30.0) * std::cos(angle) + (y - 30.0) * std::sin(angle)); };
  const HeightGrid heights = Heights(grid, [&](int column, int row) { return plane(column + 0.5, row + 0.5); });
  const double x = AnyReal(1.0, 59.0);
  const double y = AnyReal(1.0, 59.0);
  const double eye_x = AnyReal(-40.0, 100.0);
  const double eye_y = AnyReal(-40.0, 100.0);
  const Eigen::Vector3d eye = AtCells(grid, eye_x, eye_y, plane(eye_x, eye_y) + AnyReal(0.0, 80.0));
  RC_ASSERT(heights.IsVisible(AtCells(grid, x, y, plane(x, y)), eye, 0.72 * slope));
}

TEST(HeightGrid, SeesASlopeAlongTheLineWithoutSlack) {
  const gis::MapGrid grid = GridOf(60, 9, 0.2);
  const HeightGrid heights = Heights(grid, [](int column, int) { return 2.0 * column * 0.2; });
  for (double x = 0.3; x < 58.0; x += 0.7) {
    const Eigen::Vector3d place = AtCells(grid, x, 4.3, 2.0 * (x - 0.5) * 0.2);
    EXPECT_TRUE(heights.IsVisible(place, AtCells(grid, 90.0, 4.3, 2.0 * 89.5 * 0.2 + 0.1), 0.0)) << x;
    EXPECT_FALSE(heights.IsVisible(place, AtCells(grid, 90.0, 4.3, 2.0 * 89.5 * 0.2 - 1.0), 0.0)) << x;
  }
}

TEST(HeightGrid, LooksThroughHolesAndPastTheGrid) {
  const gis::MapGrid grid = GridOf(40, 40, 0.5);
  const Eigen::Vector3d place = AtCells(grid, 30.2, 20.3, 0.0);
  const Eigen::Vector3d eye = AtCells(grid, -20.0, 21.0, 15.0);
  const auto with_wall = [&](double height) { return Heights(grid, [=](int column, int) { return column == 15 ? height : 0.0; }); };
  EXPECT_FALSE(with_wall(10.0).IsVisible(place, eye, 0.0));
  EXPECT_TRUE(with_wall(10.0).IsVisible(place, eye, 7.0));
  EXPECT_TRUE(with_wall(kNoSurface).IsVisible(place, eye, 0.0));
  EXPECT_TRUE(Heights(grid, [](int, int) { return kNoSurface; }).IsVisible(place, eye, 0.0));
  // Both ends outside, the wall between them; then a line that misses the grid.
  EXPECT_FALSE(with_wall(10.0).IsVisible(AtCells(grid, 60.0, 20.3, 0.0), eye, 0.0));
  EXPECT_TRUE(with_wall(10.0).IsVisible(AtCells(grid, 60.0, 50.3, 0.0), AtCells(grid, -20.0, 45.0, 15.0), 0.0));
  EXPECT_TRUE(with_wall(10.0).IsVisible(AtCells(grid, 60.0, 50.0, 0.0), AtCells(grid, -20.0, 50.0, 15.0), 0.0));
  // Straight up beside the wall.
  EXPECT_TRUE(with_wall(10.0).IsVisible(AtCells(grid, 16.2, 20.3, 0.0), AtCells(grid, 16.2, 20.3, 90.0), 0.0));
  EXPECT_FALSE(with_wall(10.0).IsVisible({place.x(), place.y(), std::nan("")}, eye, 0.0));
}

RC_GTEST_PROP(HeightGrid, HidesWhatAnyCellHides, ()) {
  const gis::MapGrid grid = GridOf(*rc::gen::inRange(1, 70), *rc::gen::inRange(1, 70), 0.25);
  std::mt19937 random(*rc::gen::arbitrary<uint32_t>());
  const unsigned seldom = *rc::gen::inRange(1U, 600U);
  const HeightGrid heights = Heights(grid, [&](int, int) {
    const unsigned kind = random() % seldom;
    return kind == 1 ? kNoSurface : kind == 0 ? 0.01 * static_cast<double>(random() % 800) : 0.0;
  });
  const Eigen::Vector3d place = AtCells(grid, AnyReal(-10.0, grid.width + 10.0), AnyReal(-10.0, grid.height + 10.0), AnyReal(0.0, 3.0));
  const Eigen::Vector3d eye = AtCells(grid, AnyReal(-50.0, 120.0), AnyReal(-50.0, 120.0), AnyReal(-2.0, 30.0));
  const double slack_m = AnyReal(0.0, 0.5);
  const bool hidden = !heights.IsVisible(place, eye, slack_m);
  if (IsHiddenByAnyCell(heights, place, eye, slack_m, -1e-9)) RC_ASSERT(hidden);
  if (hidden) RC_ASSERT(IsHiddenByAnyCell(heights, place, eye, slack_m, 1e-9));
}

// A roof 8 m high on sloping ground, and a wood beside it whose heights are not sure.
TEST(SightSlack, IsLargeInRoughCrownsAndSmallOnBothSidesOfARoofsEdge) {
  const gis::MapGrid grid = GridOf(80, 60, 0.25);
  base::Random random(4);
  const HeightGrid heights = Heights(grid, [&](int column, int row) {
    const double ground = 100.0 + 0.1 * column + 0.05 * row;
    if (column >= 50) return ground + 6.0 + random.Uniform(-1.0, 1.0);
    return column >= 15 && column < 35 && row >= 15 && row < 45 ? ground + 8.0 : ground;
  });
  base::ThreadPool threads(2);
  const std::vector<float> slack_m = SightSlack(heights, threads);
  ASSERT_EQ(slack_m.size(), grid.size());
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const float slack = slack_m[grid.Index(column, row)];
      if (column < 40) EXPECT_NEAR(slack, 1.5 * grid.resolution_m, 0.01) << column << " " << row;
      if (column >= 60 && column < 72 && row >= 8 && row < 52) EXPECT_GT(slack, 0.6F) << column << " " << row;
    }
  }
}

}  // namespace
}  // namespace skyquilt::products
