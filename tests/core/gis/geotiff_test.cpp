#include "core/gis/geotiff.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/core/gis/open_dataset.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/limited_file_size.h"

namespace skyquilt::gis {
namespace {

using GeoTiff = InTemporaryFolder;

constexpr float kNoData = -9999.0F;

MapGrid Grid(int width, int height) {
  return {.georeferenced = true, .zone = {31, true}, .left = 430000.0, .top = 4580000.0, .resolution_m = 0.5, .width = width, .height = height};
}

GeoTiffSpec HeightSpec(int width, int height) {
  GeoTiffSpec spec;
  spec.grid = Grid(width, height);
  spec.type = PixelType::kFloat32;
  spec.nodata = static_cast<double>(kNoData);
  spec.band_names = {"height"};
  spec.unit = "m";
  spec.metadata = {{"TIFFTAG_SOFTWARE", "skyquilt"}, {"TIFFTAG_IMAGEDESCRIPTION", "A map."}, {"VERTICAL_REFERENCE", "ellipsoid"}};
  return spec;
}

float HeightAt(int column, int row) {
  if ((column / 40 + row / 40) % 7 == 0) return kNoData;
  return static_cast<float>(100.0 + 0.1 * column - 0.03 * row + std::sin(0.37 * column * row));
}

void WriteHeights(GeoTiffWriter* writer, int width, int height) {
  for (int first = 0; first < height; first += GeoTiffWriter::kTile) {
    const int rows = std::min(GeoTiffWriter::kTile, height - first);
    std::vector<float> values;
    for (int row = first; row < first + rows; ++row) {
      for (int column = 0; column < width; ++column) values.push_back(HeightAt(column, row));
    }
    writer->WriteRows(first, rows, std::span<const float>(values));
  }
}

std::string Item(GDALDataset* dataset, const char* key, const char* domain = nullptr) {
  const char* value = dataset->GetMetadataItem(key, domain);
  return value == nullptr ? "" : value;
}

// Also where cells do not divide evenly among pixels, and beside cells without data.
TEST(ReadReduced, KeepsTheHighestOfEachPixel) {
  const TemporaryFolder folder;
  constexpr int kWidth = 310, kHeight = 205;
  GeoTiffWriter writer(folder / "dsm.tif", HeightSpec(kWidth, kHeight));
  WriteHeights(&writer, kWidth, kHeight);
  writer.Close();
  for (const int width : {1, 64, 155, 309, kWidth, 1000}) {
    const ReducedRaster reduced = ReadReduced(folder / "dsm.tif", width, Reduction::kMaximum);
    const image::ImageF& image = reduced.image;
    ASSERT_EQ(image.width, std::min(width, kWidth));
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        float highest = std::nanf("");
        for (int row = 0; row < kHeight; ++row) {
          if (row + 1 <= y * reduced.scale_down + 1e-9 || row >= (y + 1) * reduced.scale_down - 1e-9) continue;
          const int first = static_cast<int>(x * reduced.scale + 1e-9), end = static_cast<int>(std::ceil((x + 1) * reduced.scale - 1e-9));
          for (int column = first; column < end; ++column) {
            if (const float height = HeightAt(column, row); height != kNoData) highest = std::fmax(highest, height);
          }
        }
        const float found = *image.At(x, y);
        ASSERT_TRUE(std::isnan(highest) ? std::isnan(found) : found == highest) << width << ": " << x << ", " << y;
      }
    }
  }
}

TEST_F(GeoTiff, IsCloudOptimisedAndComplete) {
  const std::filesystem::path file = folder_ / "map.tif";
  {
    GeoTiffWriter writer(file, HeightSpec(1100, 700));
    WriteHeights(&writer, 1100, 700);
    EXPECT_FALSE(std::filesystem::exists(file));
    writer.Close();
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) EXPECT_EQ(entry.path(), file);
  const OpenedDataset map = OpenDataset(file, GDAL_OF_RASTER);
  ASSERT_NE(map, nullptr);
  EXPECT_EQ(Item(map.get(), "LAYOUT", "IMAGE_STRUCTURE"), "COG");
  EXPECT_EQ(Item(map.get(), "COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
  EXPECT_EQ(Item(map.get(), "TIFFTAG_SOFTWARE"), "skyquilt");
  EXPECT_EQ(Item(map.get(), "TIFFTAG_IMAGEDESCRIPTION"), "A map.");
  EXPECT_EQ(Item(map.get(), "VERTICAL_REFERENCE"), "ellipsoid");
  EXPECT_EQ(Item(map.get(), "AREA_OR_POINT"), "Area");
  ASSERT_NE(map->GetSpatialRef(), nullptr);
  EXPECT_STREQ(map->GetSpatialRef()->GetAuthorityCode(nullptr), "32631");
  double transform[6] = {};
  map->GetGeoTransform(transform);
  EXPECT_EQ(transform[0], 430000.0);
  EXPECT_EQ(transform[3], 4580000.0);
  EXPECT_EQ(transform[5], -0.5);
  GDALRasterBand& band = *map->GetRasterBand(1);
  EXPECT_STREQ(band.GetDescription(), "height");
  EXPECT_STREQ(band.GetUnitType(), "m");
  EXPECT_EQ(band.GetNoDataValue(), static_cast<double>(kNoData));
  ASSERT_EQ(band.GetOverviewCount(), 3);
  EXPECT_EQ(band.GetOverview(0)->GetXSize(), 550);
  std::vector<float> values(1100 * 700);
  ASSERT_EQ(band.RasterIO(GF_Read, 0, 0, 1100, 700, values.data(), 1100, 700, GDT_Float32, 0, 0, nullptr), CE_None);
  size_t wrong = 0;
  for (int row = 0; row < 700; ++row) {
    for (int column = 0; column < 1100; ++column) {
      if (values[static_cast<size_t>(row) * 1100 + static_cast<size_t>(column)] != HeightAt(column, row)) ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0U);
  // Overviews are averages of cells with data: a mean with no data in it would be far below.
  std::vector<float> overview(550 * 350);
  ASSERT_EQ(band.GetOverview(0)->RasterIO(GF_Read, 0, 0, 550, 350, overview.data(), 550, 350, GDT_Float32, 0, 0, nullptr), CE_None);
  const float mean = (HeightAt(200, 60) + HeightAt(201, 60) + HeightAt(200, 61) + HeightAt(201, 61)) / 4.0F;
  EXPECT_NEAR(overview[30 * 550 + 100], mean, 1e-3);
  for (const float value : overview) EXPECT_TRUE(value == kNoData || value > 50.0F) << value;
}

TEST_F(GeoTiff, TheSameRowsGiveTheSameBytes) {
  for (const char* name : {"a.tif", "b.tif"}) {
    GeoTiffWriter writer(folder_ / name, HeightSpec(1500, 600));
    WriteHeights(&writer, 1500, 600);
    writer.Close();
  }
  EXPECT_TRUE(base::ReadFile(folder_ / "a.tif") == base::ReadFile(folder_ / "b.tif"));
}

TEST_F(GeoTiff, OneCellAndFourBands) {
  GeoTiffSpec spec;
  spec.grid = Grid(1, 1);
  spec.grid.georeferenced = false;
  spec.bands = 4;
  GeoTiffWriter writer(folder_ / "one.tif", spec);
  const std::vector<uint8_t> rgba = {10, 20, 30, 255};
  writer.WriteRows(0, 1, std::span<const uint8_t>(rgba));
  writer.Close();
  const OpenedDataset map = OpenDataset(folder_ / "one.tif", GDAL_OF_RASTER);
  ASSERT_NE(map, nullptr);
  EXPECT_EQ(map->GetRasterBand(1)->GetColorInterpretation(), GCI_RedBand);
  EXPECT_EQ(map->GetRasterBand(4)->GetColorInterpretation(), GCI_AlphaBand);
  EXPECT_TRUE(map->GetSpatialRef() == nullptr || map->GetSpatialRef()->IsEmpty());
  std::vector<uint8_t> read(4);
  ASSERT_EQ(map->RasterIO(GF_Read, 0, 0, 1, 1, read.data(), 1, 1, GDT_Byte, 4, nullptr, 4, 4, 1, nullptr), CE_None);
  EXPECT_EQ(read, rgba);
}

TEST_F(GeoTiff, FailuresLeaveNothingBehind) {
  const std::string missing = InputErrorOf([&] { GeoTiffWriter(folder_ / "no_such_folder/map.tif", HeightSpec(10, 10)); });
  EXPECT_NE(missing.find("map.tif: cannot be created"), std::string::npos) << missing;
  const auto write = [&] {
    GeoTiffWriter writer(folder_ / "map.tif", HeightSpec(1100, 700));
    WriteHeights(&writer, 1100, 700);
    writer.Close();
  };
  write();
  const auto size = std::filesystem::file_size(folder_ / "map.tif");
  std::filesystem::remove(folder_ / "map.tif");
  // The first limit stops the plain file, the others the copy, which is larger by its overviews; the last one at its last block.
  for (const rlim_t limit : {rlim_t{20000}, size / 100 * 90, size / 100 * 97, size - 100}) {
    const LimitedFileSize full(limit);
    const std::string error = InputErrorOf(write);
    EXPECT_NE(error.find("Check the free space"), std::string::npos) << limit << " of " << size << ": " << error;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(GeoTiff, CancellingLeavesNothingBehind) {
  {
    GeoTiffWriter writer(folder_ / "map.tif", HeightSpec(1100, 700));
    WriteHeights(&writer, 1100, 700);
    ExpectStopsWhenAsked([&] { writer.Close(); });
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace skyquilt::gis
