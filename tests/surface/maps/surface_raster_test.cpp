#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/progress.h"
#include "core/geo/enu_frame.h"
#include "surface/maps/surface_maps.h"
#include "tests/support/error_of.h"

namespace skyquilt::surface {
namespace {

MapFrame LocalFrame() {
  return MapFrame(scene::SceneInfo{});
}

scene::SceneInfo Barcelona() {
  scene::SceneInfo info;
  info.georeferenced = true;
  info.origin = {41.38, 2.17, 50.0};
  info.min_enu = {-100.0, -100.0, 0.0};
  info.max_enu = {100.0, 100.0, 30.0};
  return info;
}

MeshTile TileOf(const std::vector<Eigen::Vector3d>& position, const std::vector<Triangle>& triangle, int column = 0) {
  MeshTile tile;
  tile.id = {0, column, 0};
  tile.mesh.position = position;
  tile.mesh.triangle = triangle;
  return tile;
}

// A pyramid over the square from (0, 0) to (20, 20), 10 m high.
double PyramidHeight(double x, double y) {
  return 10.0 - std::max(std::abs(x - 10.0), std::abs(y - 10.0));
}
MeshTile Pyramid() {
  return TileOf({{0, 0, 0}, {20, 0, 0}, {20, 20, 0}, {0, 20, 0}, {10, 10, 10}}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
}

TEST(SurfaceRaster, PyramidIsExactAtCentres) {
  const std::vector<MeshTile> tiles = {Pyramid()};
  const gis::MapGrid grid = PlanSurfaceGrid(tiles, LocalFrame(), 0.4);
  EXPECT_EQ(grid.width, 50);
  EXPECT_EQ(grid.height, 50);
  EXPECT_EQ(grid.left, 0.0);
  EXPECT_NEAR(grid.top, 20.0, 1e-12);
  const HeightRaster raster = RasteriseSurface(tiles, LocalFrame(), grid);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Eigen::Vector2d at = grid.CellCentre(column, row);
      EXPECT_NEAR(raster.height_m[static_cast<size_t>(row * 50 + column)], PyramidHeight(at.x(), at.y()), 1e-5);
    }
  }
}

TEST(SurfaceRaster, TheHighestWinsInAnyOrder) {
  const MeshTile roof = TileOf({{5, 5, 30}, {15, 5, 30}, {5, 15, 30}}, {{0, 1, 2}}, 1);
  // Coarser levels are the same surface again, less exactly.
  MeshTile coarse = TileOf({{0, 0, 99}, {20, 0, 99}, {0, 20, 99}}, {{0, 1, 2}});
  coarse.id.level = 1;
  const std::vector<MeshTile> tiles = {Pyramid(), roof, coarse}, reversed = {coarse, roof, Pyramid()};
  const gis::MapGrid grid = PlanSurfaceGrid(tiles, LocalFrame(), 1.0);
  const HeightRaster raster = RasteriseSurface(tiles, LocalFrame(), grid);
  EXPECT_EQ(raster.height_m, RasteriseSurface(reversed, LocalFrame(), grid).height_m);
  EXPECT_EQ(raster.height_m[static_cast<size_t>(20 - 1 - 7) * 20 + 7], 30.0F);
  EXPECT_NEAR(raster.height_m[static_cast<size_t>(20 - 1 - 17) * 20 + 17], 2.5F, 1e-6F);
}

TEST(SurfaceRaster, WallsAndSmallTrianglesLeaveNoTrace) {
  const std::vector<MeshTile> tiles = {
      TileOf({{0, 0, 0}, {0, 10, 0}, {0, 10, 20}, {4.1, 4.1, 7}, {4.2, 4.1, 7}, {4.1, 4.2, 7}, {9, 9, 1}}, {{0, 1, 2}, {3, 4, 5}, {6, 6, 6}})};
  const gis::MapGrid grid = PlanSurfaceGrid(tiles, LocalFrame(), 1.0);
  for (const float height : RasteriseSurface(tiles, LocalFrame(), grid).height_m) EXPECT_TRUE(std::isnan(height));
  // A wall through centres that leans by less than rounding stays within its own heights.
  const std::vector<MeshTile> wall = {TileOf({{0.5, 0, 0}, {0.5 + 1e-9, 10, 0}, {0.5, 10, 20}}, {{0, 1, 2}})};
  for (const float height : RasteriseSurface(wall, LocalFrame(), grid).height_m)
    EXPECT_TRUE(std::isnan(height) || (height >= 0.0F && height <= 20.0F));
}

TEST(SurfaceRaster, EmptyBrokenAndSingle) {
  const MapFrame frame = LocalFrame();
  const gis::MapGrid none = PlanSurfaceGrid({}, frame, 0.5);
  EXPECT_EQ(none.width * none.height, 0);
  EXPECT_TRUE(RasteriseSurface({}, frame, none).height_m.empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<MeshTile> broken = {TileOf({{nan, 0, 0}, {1, 1, 1}, {2, nan, 0}}, {{0, 1, 2}})};
  const gis::MapGrid one = PlanSurfaceGrid(broken, frame, 0.5);
  EXPECT_EQ(one.width, 1);
  EXPECT_EQ(one.height, 1);
  EXPECT_TRUE(std::isnan(RasteriseSurface(broken, frame, one).height_m[0]));
  EXPECT_THROW(PlanSurfaceGrid(broken, frame, 0.0), std::logic_error);
}

TEST(SurfaceRaster, TooManyCellsAreRefusedWithAdvice) {
  const std::vector<MeshTile> tiles = {TileOf({{0, 0, 0}, {3000, 0, 0}, {0, 2000, 0}}, {{0, 1, 2}})};
  const std::string error = UsageErrorOf([&] { PlanSurfaceGrid(tiles, LocalFrame(), 0.1); });
  EXPECT_NE(error.find("set products.resolution_m to at least 0.5"), std::string::npos) << error;
  EXPECT_EQ(PlanSurfaceGrid(tiles, LocalFrame(), 0.5).width, 6000);
}

TEST(SurfaceRaster, LiesInTheZoneOfTheSurvey) {
  const MapFrame frame(Barcelona());
  // A level plane of ENU that is raised by 1 m at one corner.
  const std::vector<MeshTile> tiles = {TileOf({{-90, -90, 10}, {90, -90, 10}, {90, 90, 11}, {-90, 90, 10}}, {{0, 1, 2}, {0, 2, 3}})};
  const gis::MapGrid grid = PlanSurfaceGrid(tiles, frame, 0.5);
  EXPECT_TRUE(grid.georeferenced);
  EXPECT_EQ(grid.zone.Epsg(), 32631);
  EXPECT_EQ(std::fmod(grid.left, 0.5), 0.0);
  EXPECT_EQ(std::fmod(grid.top, 0.5), 0.0);
  const HeightRaster raster = RasteriseSurface(tiles, frame, grid);
  const geo::EnuFrame enu(Barcelona().origin);
  int checked = 0;
  for (double x = -80; x < 80; x += 7.3) {
    for (double y = -80; y < 80; y += 9.1) {
      const double z = 10.0 + (x > y ? (y + 90) / 180 : (x + 90) / 180);
      const geo::Geodetic place = enu.GeodeticFromEnu({x, y, z});
      const Eigen::Vector2d cell = grid.CellOf(geo::UtmFromGeodetic(place, grid.zone));
      const auto column = static_cast<int>(std::lround(cell.x())), row = static_cast<int>(std::lround(cell.y()));
      EXPECT_NEAR(raster.height_m[grid.Index(column, row)], place.height_m, 0.01);
      ++checked;
    }
  }
  EXPECT_GT(checked, 300);
}

// A height field of triangles, cut into tiles along a random line of columns: every centre inside is covered.
RC_GTEST_PROP(SurfaceRaster, SeamsLeaveNoGap, ()) {
  base::Progress::SetQuiet(true);
  const auto n = *rc::gen::inRange(1, 12);
  const auto jitter = [] { return 0.05 * *rc::gen::inRange(-6, 7); };
  std::vector<Eigen::Vector3d> position;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const bool edge = i == 0 || j == 0 || i == n || j == n;
      position.emplace_back(i + (edge ? 0.0 : jitter()), j + (edge ? 0.0 : jitter()), jitter());
    }
  }
  const auto cut = *rc::gen::inRange(0, n + 1);
  std::vector<Triangle> west, east;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<uint32_t>(j * (n + 1) + i);
      const auto above = a + static_cast<uint32_t>(n) + 1;
      std::vector<Triangle>& side = i < cut ? west : east;
      side.push_back({a, a + 1, above + 1});
      side.push_back({a, above + 1, above});
    }
  }
  const std::vector<MeshTile> tiles = {TileOf(position, west), TileOf(position, east, 1)};
  const gis::MapGrid grid = PlanSurfaceGrid(tiles, LocalFrame(), *rc::gen::element(0.1, 0.25, 0.5, 2.0));
  RC_ASSERT(grid.width >= 1 && grid.height >= 1);
  const HeightRaster raster = RasteriseSurface(tiles, LocalFrame(), grid);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Eigen::Vector2d at = grid.CellCentre(column, row);
      if (at.x() > n || at.y() > n) continue;
      const float height = raster.height_m[static_cast<size_t>(row * grid.width + column)];
      RC_ASSERT(std::abs(height) <= 0.31F);
    }
  }
  base::Progress::SetQuiet(false);
}

}  // namespace
}  // namespace skyquilt::surface
