#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "buildings/points/surface_points.h"
#include "core/gis/geotiff.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::buildings {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

scene::SceneInfo Info(bool georeferenced) {
  scene::SceneInfo info;
  info.georeferenced = georeferenced;
  info.origin = {47.3769, 8.5417, 408.0};
  info.min_enu = {-200, -200, -10};
  info.max_enu = {200, 200, 50};
  return info;
}

// The grid of a map whose cells lie around a place in ENU.
gis::MapGrid GridAround(const surface::MapFrame& frame, const Eigen::Vector3d& enu, double half_m, double resolution_m) {
  const Eigen::Vector3d middle = frame.MapFromEnu(enu);
  const int n = static_cast<int>(2.0 * half_m / resolution_m);
  return {.georeferenced = frame.georeferenced(),
          .zone = frame.zone(),
          .left = std::floor(middle.x() - half_m),
          .top = std::ceil(middle.y() + half_m),
          .resolution_m = resolution_m,
          .width = n,
          .height = n};
}

template <typename Height>
void WriteMap(const gis::MapGrid& grid, const Height& height, const std::filesystem::path& file) {
  std::vector<float> values;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) values.push_back(height(grid.CellCentre(column, row)));
  }
  gis::GeoTiffWriter writer(
      file, {.grid = grid, .type = gis::PixelType::kFloat32, .bands = 1, .nodata = -9999.0, .band_names = {}, .unit = "m", .metadata = {}});
  writer.WriteRows(0, grid.height, std::span<const float>(values));
  writer.Close();
}

RC_GTEST_PROP(GroundGrid, IsExactOnPlanes, ()) {
  const double dx = *rc::gen::inRange(-40, 41) / 100.0, dy = *rc::gen::inRange(-40, 41) / 100.0, cell_m = *rc::gen::inRange(1, 40) / 10.0;
  const Eigen::Vector2d origin(-3.0, 7.0);
  const auto plane = [&](const Eigen::Vector2d& at) { return 5.0 + dx * at.x() + dy * at.y(); };
  std::vector<float> heights;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 9; ++column) heights.push_back(static_cast<float>(plane(origin + cell_m * Eigen::Vector2d(column, row))));
  }
  const GroundGrid grid(origin, cell_m, 9, 6, heights);
  const Eigen::Vector2d at = origin + cell_m * Eigen::Vector2d(*rc::gen::inRange(0, 801) / 100.0, *rc::gen::inRange(0, 501) / 100.0);
  RC_ASSERT(std::abs(grid.At(at) - plane(at)) < 1e-4);
}

TEST(GroundGrid, HasNoHeightOutsideAndBesideHoles) {
  const GroundGrid grid({0, 0}, 2.0, 3, 2, {1, 2, kNone, 3, 4, 5});
  EXPECT_DOUBLE_EQ(grid.At({1.0, 1.0}), 2.5);
  EXPECT_DOUBLE_EQ(grid.At({2.0, 2.0}), 4.0);
  // On the edge of the cells that have heights.
  EXPECT_DOUBLE_EQ(grid.At({2.0, 1.0}), 3.0);
  EXPECT_DOUBLE_EQ(grid.At({4.0, 2.0}), 5.0);
  EXPECT_TRUE(std::isnan(grid.At({2.1, 1.0})));
  EXPECT_TRUE(std::isnan(grid.At({-0.01, 1.0})));
  EXPECT_TRUE(std::isnan(grid.At({1.0, 2.01})));
  EXPECT_TRUE(std::isnan(grid.At({std::nan(""), 0.0})));
  EXPECT_EQ(grid.max(), Eigen::Vector2d(4, 2));
}

TEST(GroundGrid, OfOneRowOrCell) {
  const GroundGrid row({0, 0}, 1.0, 3, 1, {1, 2, 3});
  EXPECT_DOUBLE_EQ(row.At({1.5, 0.0}), 2.5);
  EXPECT_TRUE(std::isnan(row.At({1.5, 0.1})));
  const GroundGrid cell({5, 6}, 1.0, 1, 1, {7});
  EXPECT_DOUBLE_EQ(cell.At({5, 6}), 7.0);
  EXPECT_THROW(GroundGrid({0, 0}, 1.0, 2, 2, {1, 2, 3}), std::logic_error);
}

// Far from the origin, where the map's north and plumb line differ from ENU's, and the Earth's surface falls below its plane by a decimetre.
TEST(GroundGrid, ReadsAMapIntoEnu) {
  const TemporaryFolder folder;
  const surface::MapFrame frame(Info(true));
  const gis::MapGrid grid = GridAround(frame, {1200.0, -900.0, 15.0}, 60.0, 0.25);
  const auto height = [&](const Eigen::Vector2d& map) {
    return static_cast<float>(420.0 + 0.2 * (map.x() - grid.left) + 0.05 * (map.y() - grid.top));
  };
  WriteMap(grid, height, folder / "dtm.tif");
  const GroundGrid ground = GroundGrid::Read(folder / "dtm.tif", frame);
  EXPECT_GE(ground.cell_m(), 0.25);
  EXPECT_LE(ground.cell_m(), 0.75);
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(1200, -900), Eigen::Vector2d(1160, -880), Eigen::Vector2d(1240.3, -945.1)}) {
    const double z = ground.At(place);
    const Eigen::Vector3d map = frame.MapFromEnu({place.x(), place.y(), z});
    EXPECT_NEAR(map.z(), static_cast<double>(height(map.head<2>())), 2e-3) << place.transpose();
  }
  EXPECT_TRUE(std::isnan(ground.At({1300, -900})));
}

TEST(GroundGrid, ReadsLocalMapsAndKeepsHoles) {
  const TemporaryFolder folder;
  const surface::MapFrame frame(Info(false));
  const gis::MapGrid grid = GridAround(frame, {0, 0, 0}, 20.0, 0.5);
  WriteMap(
      grid, [](const Eigen::Vector2d& map) { return map.norm() < 5.0 ? -9999.0F : static_cast<float>(0.1 * map.x()); }, folder / "dtm.tif");
  const GroundGrid ground = GroundGrid::Read(folder / "dtm.tif", frame);
  EXPECT_NEAR(ground.At({10.2, -7.7}), 1.02, 1e-4);
  EXPECT_NEAR(ground.At({-15.0, 12.0}), -1.5, 1e-4);
  EXPECT_TRUE(std::isnan(ground.At({1.0, 2.0})));
  EXPECT_TRUE(std::isnan(ground.At({25.0, 0.0})));
}

TEST(GroundGrid, MissingMapIsAnInputError) {
  const TemporaryFolder folder;
  const surface::MapFrame frame(Info(true));
  EXPECT_NE(InputErrorOf([&] { GroundGrid::Read(folder / "dtm.tif", frame); }).find("does not exist"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::buildings
