#include "core/gis/read_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/file.h"
#include "core/gis/contours.h"
#include "core/gis/geotiff.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::gis {
namespace {

using ReadMaps = InTemporaryFolder;

constexpr float kNoHeight = std::numeric_limits<float>::quiet_NaN();

MapGrid SmallGrid(bool georeferenced, const geo::UtmZone& zone) {
  return {.georeferenced = georeferenced, .zone = zone, .left = 500000.5, .top = 7000000.0, .resolution_m = 0.5, .width = 60, .height = 40};
}

// One band: the column, and no data in the first row.
void WriteColumns(const MapGrid& grid, const std::filesystem::path& file) {
  std::vector<float> values;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) values.push_back(row == 0 ? -9999.0F : static_cast<float>(column));
  }
  GeoTiffWriter writer(file,
                       {.grid = grid, .type = PixelType::kFloat32, .bands = 1, .nodata = -9999.0, .band_names = {}, .unit = "m", .metadata = {}});
  writer.WriteRows(0, grid.height, std::span<const float>(values));
  writer.Close();
}

TEST_F(ReadMaps, FindsPlaceAndZone) {
  for (const geo::UtmZone& zone : {geo::UtmZone{32, true}, geo::UtmZone{17, false}, geo::UtmZone{0, true}, geo::UtmZone{0, false}}) {
    const MapGrid grid = SmallGrid(true, zone);
    WriteColumns(grid, folder_ / "map.tif");
    const MapGrid read = ReadMapGrid(folder_ / "map.tif");
    EXPECT_TRUE(read.georeferenced);
    EXPECT_EQ(read.zone.Epsg(), zone.Epsg());
    EXPECT_EQ(read.left, grid.left);
    EXPECT_EQ(read.top, grid.top);
    EXPECT_EQ(read.resolution_m, grid.resolution_m);
    EXPECT_EQ(read.width, grid.width);
    EXPECT_EQ(read.height, grid.height);
  }
  WriteColumns(SmallGrid(false, {}), folder_ / "local.tif");
  EXPECT_FALSE(ReadMapGrid(folder_ / "local.tif").georeferenced);
  base::WriteFileAtomically(folder_ / "bad.tif", "II*");
  EXPECT_NE(InputErrorOf([&] { ReadMapGrid(folder_ / "bad.tif"); }), "");
  EXPECT_NE(InputErrorOf([&] { ReadMapGrid(folder_ / "none.tif"); }).find("does not exist"), std::string::npos);
}

TEST_F(ReadMaps, AWindowHasTheCellsOfTheFile) {
  WriteColumns(SmallGrid(true, {32, true}), folder_ / "map.tif");
  const MapReader reader(folder_ / "map.tif");
  EXPECT_EQ(reader.grid().width, 60);
  const image::ImageF window = reader.Read(-2, 0, 70, 3);
  ASSERT_EQ(window.width, 70);
  ASSERT_EQ(window.height, 3);
  for (const int x : {0, 1, 62, 69}) EXPECT_TRUE(std::isnan(*window.At(x, 1))) << "beyond the map";
  EXPECT_TRUE(std::isnan(*window.At(10, 0))) << "no data";
  for (int x = 0; x < 60; ++x) EXPECT_EQ(*window.At(x + 2, 2), static_cast<float>(x));
  EXPECT_TRUE(std::isnan(*reader.Read(0, 40, 1, 1).At(0, 0)));
}

TEST_F(ReadMaps, APartIsWhereItWasAskedFor) {
  const MapGrid grid = SmallGrid(true, {32, true});
  WriteColumns(grid, folder_ / "map.tif");
  const auto at_columns = [&](double from, double to) {
    return Eigen::AlignedBox2d(Eigen::Vector2d(grid.left + 0.5 * from, grid.top - 10.0), Eigen::Vector2d(grid.left + 0.5 * to, grid.top - 5.0));
  };
  // Pixel centres at columns 20.5, 24.5 ...: the mean of cells 19 to 22, 23 to 26 ... is 20.5, 24.5 ... minus the half from edge to centre.
  const image::ImageF reduced = ReadMapPart(folder_ / "map.tif", at_columns(18.5, 38.5), 5, 3);
  for (int x = 0; x < 5; ++x) EXPECT_NEAR(*reduced.At(x, 1), 18.5 + 4.0 * (x + 0.5) - 0.5, 0.3);
  const image::ImageF same = ReadMapPart(folder_ / "map.tif", at_columns(18.5, 38.5), 20, 10);
  for (int x = 0; x < 20; ++x) EXPECT_NEAR(*same.At(x, 5), 18.5 + (x + 0.5) - 0.5, 0.01);
  // Half of it beyond the eastern edge.
  const image::ImageF outside = ReadMapPart(folder_ / "map.tif", at_columns(50.0, 70.0), 20, 10);
  EXPECT_NEAR(*outside.At(9, 5), 59.0, 0.01);
  EXPECT_TRUE(std::isnan(*outside.At(10, 5)));
  const Eigen::AlignedBox2d all(Eigen::Vector2d(grid.left, grid.top - 20.0), Eigen::Vector2d(grid.left + 30.0, grid.top));
  const image::ImageF whole = ReadMapPart(folder_ / "map.tif", all, 60, 40);
  EXPECT_TRUE(std::isnan(*whole.At(30, 0))) << "no data";
  EXPECT_EQ(*whole.At(30, 39), 30.0F);
  const Eigen::AlignedBox2d far_off(Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(10.0, 10.0));
  EXPECT_TRUE(std::isnan(*ReadMapPart(folder_ / "map.tif", far_off, 4, 4).At(2, 2)));
}

TEST_F(ReadMaps, ContoursComeBackAndAreThinnedWhenThereAreTooMany) {
  for (const bool georeferenced : {true, false}) {
    const MapGrid grid = SmallGrid(georeferenced, {17, false});
    std::vector<float> heights;
    for (int row = 0; row < grid.height; ++row) {
      for (int column = 0; column < grid.width; ++column) heights.push_back(column == 59 ? kNoHeight : 0.3F + 0.2F * static_cast<float>(column));
    }
    const int64_t lines = WriteContours(grid, heights, 1.0, "ellipsoid", folder_ / "contours.gpkg");
    ASSERT_GT(lines, 8);
    const Contours all = ReadContours(folder_ / "contours.gpkg", 1'000'000);
    EXPECT_EQ(all.georeferenced, georeferenced);
    if (georeferenced) {
      EXPECT_EQ(all.zone.Epsg(), 32717);
    }
    EXPECT_FALSE(all.thinned);
    ASSERT_EQ(all.lines.size(), static_cast<size_t>(lines));
    EXPECT_EQ(all.lines[2].height_m, 3.0);
    EXPECT_NEAR(all.lines[2].map_xy[0].x(), grid.left + 0.5 * ((3.0 - 0.3) / 0.2 + 0.5), 1e-3);
    int64_t vertices = 0;
    for (const ContourLine& line : all.lines) vertices += static_cast<int64_t>(line.map_xy.size());
    const Contours fewer = ReadContours(folder_ / "contours.gpkg", vertices - 1);
    EXPECT_TRUE(fewer.thinned);
    ASSERT_FALSE(fewer.lines.empty());
    for (const ContourLine& line : fewer.lines) EXPECT_TRUE(line.index) << line.height_m;
  }
  base::WriteFileAtomically(folder_ / "bad.gpkg", "SQLite");
  EXPECT_NE(InputErrorOf([&] { ReadContours(folder_ / "bad.gpkg", 10); }), "");
}

}  // namespace
}  // namespace skyquilt::gis
