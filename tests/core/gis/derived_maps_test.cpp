#include "core/gis/derived_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <vector>

#include "core/base/file.h"
#include "core/gis/geotiff.h"
#include "core/gis/photo_bands.h"
#include "core/gis/read_maps.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::gis {
namespace {

using DerivedMaps = InTemporaryFolder;

// 40 x 20 cells of 0.1 m: red is five times the column, green 100, and the western half is transparent.
void WriteOrthophoto(const std::filesystem::path& file, int jpeg_quality) {
  const MapGrid grid{.georeferenced = true, .zone = {32, true}, .left = 500000.0, .top = 5000002.0, .resolution_m = 0.1, .width = 40, .height = 20};
  std::vector<uint8_t> values;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const bool shown = column >= 20;
      for (const int value : {shown ? 5 * column : 0, shown ? 100 : 0, 0, shown ? 255 : 0}) values.push_back(static_cast<uint8_t>(value));
    }
  }
  GeoTiffWriter writer(file, {.grid = grid, .bands = 4, .jpeg_quality = jpeg_quality, .metadata = {{"PLACE", "here"}}});
  writer.WriteRows(0, grid.height, std::span<const uint8_t>(values));
  writer.Close();
}

TEST_F(DerivedMaps, ACoarserOrthophotoHasMeansOfWhatIsShown) {
  for (const int quality : {0, 90}) {
    SCOPED_TRACE(quality);
    WriteOrthophoto(folder_ / "fine.tif", quality);
    WriteCoarserMap(folder_ / "fine.tif", folder_ / "coarse.tif", 0.4);
    const MapReader reader(folder_ / "coarse.tif");
    EXPECT_EQ(reader.grid().resolution_m, 0.4);
    EXPECT_EQ(reader.grid().left, 500000.0);
    EXPECT_EQ(reader.grid().top, 5000002.0);
    ASSERT_EQ(reader.grid().width, 10);
    ASSERT_EQ(reader.grid().height, 5);
    const image::ImageF cells = reader.Read(0, 0, 10, 5);
    const float tolerance = quality == 0 ? 0.51F : 8.0F;
    for (int column = 5; column < 10; ++column) {
      EXPECT_NEAR(cells.At(column, 2)[0], 5.0F * (4.0F * static_cast<float>(column) + 1.5F), tolerance) << column;
      EXPECT_EQ(cells.At(column, 2)[3], 255.0F);
    }
    for (int column = 0; column < 5; ++column) EXPECT_EQ(cells.At(column, 2)[3], 0.0F);
  }
}

TEST_F(DerivedMaps, CellsWithoutDataDoNotCount) {
  const MapGrid grid{.georeferenced = false, .left = 0.0, .top = 4.0, .resolution_m = 1.0, .width = 4, .height = 4};
  const float none = -9999.0F;
  const std::vector<float> values = {1, 3, none, none, none, 2, none, none, 5, 5, 7, 9, 5, 5, 7, 9};
  GeoTiffWriter writer(folder_ / "fine.tif", {.grid = grid, .type = PixelType::kFloat32, .nodata = none});
  writer.WriteRows(0, 4, std::span<const float>(values));
  writer.Close();
  WriteCoarserMap(folder_ / "fine.tif", folder_ / "coarse.tif", 2.0);
  const image::ImageF cells = MapReader(folder_ / "coarse.tif").Read(0, 0, 2, 2);
  EXPECT_NEAR(cells.At(0, 0)[0], 2.0F, 1e-5F);
  EXPECT_TRUE(std::isnan(cells.At(1, 0)[0]));
  EXPECT_NEAR(cells.At(0, 1)[0], 5.0F, 1e-5F);
  EXPECT_NEAR(cells.At(1, 1)[0], 8.0F, 1e-5F);
}

TEST_F(DerivedMaps, APictureHasAlphaAndAWorldFile) {
  for (const int quality : {0, 90}) {
    SCOPED_TRACE(quality);
    WriteOrthophoto(folder_ / "ortho.tif", quality);
    WriteMapPicture(folder_ / "ortho.tif", folder_ / "ortho.png");
    const PhotoBands picture(folder_ / "ortho.png");
    ASSERT_EQ(picture.bands(), 4);
    EXPECT_EQ(picture.width(), 40);
    std::vector<float> values(40 * 4);
    const std::vector<int> bands = {1, 2, 3, 4};
    picture.ReadRows(10, 1, bands, values);
    EXPECT_NEAR(values[4 * 30], 150.0F, quality == 0 ? 0.01F : 8.0F);
    EXPECT_EQ(values[4 * 30 + 3], 255.0F);
    EXPECT_EQ(values[4 * 10 + 3], 0.0F);
    std::istringstream world(base::ReadFile(folder_ / "ortho.wld"));
    const std::vector<double> numbers{std::istream_iterator<double>(world), {}};
    ASSERT_EQ(numbers.size(), 6U);
    EXPECT_NEAR(numbers[0], 0.1, 1e-9);
    EXPECT_NEAR(numbers[3], -0.1, 1e-9);
    EXPECT_NEAR(numbers[4], 500000.05, 1e-6);
    EXPECT_NEAR(numbers[5], 5000001.95, 1e-6);
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      EXPECT_EQ(entry.path().string().find("partial"), std::string::npos) << entry.path();
      EXPECT_NE(entry.path().extension(), ".xml") << entry.path();
    }
  }
  EXPECT_NE(InputErrorOf([&] { WriteMapPicture(folder_ / "none.tif", folder_ / "none.png"); }).find("none.tif"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::gis
