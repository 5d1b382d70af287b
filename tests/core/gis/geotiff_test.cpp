#include "core/gis/geotiff.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/gis/read_maps.h"
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

// Red rises from left to right and green from top to bottom, in a disc; black and transparent around it.
std::vector<uint8_t> DiscOfColours(int width, int height) {
  std::vector<uint8_t> rgba(static_cast<size_t>(width) * static_cast<size_t>(height) * 4, 0);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      uint8_t* const pixel = &rgba[(static_cast<size_t>(row) * static_cast<size_t>(width) + static_cast<size_t>(column)) * 4];
      if (std::hypot(column - 0.5 * width, row - 0.5 * height) > 0.4 * height) continue;
      pixel[0] = static_cast<uint8_t>(200 * column / width);
      pixel[1] = static_cast<uint8_t>(200 * row / height);
      pixel[2] = static_cast<uint8_t>((column / 3 + row / 5) % 2 == 0 ? 80 : 90);
      pixel[3] = 255;
    }
  }
  return rgba;
}

GeoTiffSpec ColourSpec(int width, int height) {
  GeoTiffSpec spec;
  spec.grid = Grid(width, height);
  spec.bands = 4;
  return spec;
}

// Overviews are read instead of all cells, and say the same.
TEST_F(GeoTiff, ReducedColoursAreMeansOfTheCells) {
  constexpr int kWidth = 2050, kHeight = 1300;
  const std::vector<uint8_t> rgba = DiscOfColours(kWidth, kHeight);
  GeoTiffWriter writer(folder_ / "map.tif", ColourSpec(kWidth, kHeight));
  writer.WriteRows(0, kHeight, std::span<const uint8_t>(rgba));
  writer.Close();
  for (const int width : {90, 205, 400, 1025}) {
    const ReducedRaster reduced = ReadReduced(folder_ / "map.tif", width);
    ASSERT_EQ(reduced.image.width, width);
    ASSERT_EQ(reduced.image.channels, 4);
    EXPECT_DOUBLE_EQ(reduced.scale, static_cast<double>(kWidth) / width);
    double worst = 0.0;
    for (int y = 0; y < reduced.image.height; ++y) {
      for (int x = 0; x < width; ++x) {
        // Away from the border of the disc, where the cells that a pixel touches depend on the overview.
        const double column = (x + 0.5) * reduced.scale, row = (y + 0.5) * reduced.scale_down;
        const double from_border = std::abs(std::hypot(column - 0.5 * kWidth, row - 0.5 * kHeight) - 0.4 * kHeight);
        if (from_border < 3.0 * reduced.scale) continue;
        const bool inside = std::hypot(column - 0.5 * kWidth, row - 0.5 * kHeight) < 0.4 * kHeight;
        const float* const pixel = reduced.image.At(x, y);
        ASSERT_EQ(pixel[3], inside ? 255.0F : 0.0F) << x << ", " << y;
        if (!inside) continue;
        worst = std::max({worst, std::abs(static_cast<double>(pixel[0]) - (200.0 * column / kWidth - 0.5)),
                          std::abs(static_cast<double>(pixel[1]) - (200.0 * row / kHeight - 0.5))});
      }
    }
    EXPECT_LT(worst, 1.2) << width << ": whole numbers, rounded twice";
  }
}

TEST_F(GeoTiff, LabelsKeepTheirValues) {
  constexpr int kWidth = 1500, kHeight = 1100;
  GeoTiffSpec spec;
  spec.grid = Grid(kWidth, kHeight);
  spec.type = PixelType::kUint16;
  spec.labels = true;
  spec.nodata = 0.0;
  std::vector<uint16_t> labels;
  const auto label = [](int column, int row) {
    return static_cast<uint16_t>(row < 100 ? 0 : (column / 7 + row / 7) % 2 == 0 ? 65535 : 2 + 10 * (column / 100));
  };
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) labels.push_back(label(column, row));
  }
  GeoTiffWriter writer(folder_ / "labels.tif", spec);
  for (int first = 0; first < kHeight; first += GeoTiffWriter::kTile) {
    const int rows = std::min(GeoTiffWriter::kTile, kHeight - first);
    writer.WriteRows(first, rows, std::span<const uint16_t>(labels).subspan(static_cast<size_t>(first) * kWidth, static_cast<size_t>(rows) * kWidth));
  }
  writer.Close();
  const OpenedDataset map = OpenDataset(folder_ / "labels.tif", GDAL_OF_RASTER);
  ASSERT_NE(map, nullptr);
  GDALRasterBand& band = *map->GetRasterBand(1);
  EXPECT_EQ(band.GetRasterDataType(), GDT_UInt16);
  int columns = 0, rows = 0;
  band.GetBlockSize(&columns, &rows);
  EXPECT_EQ(columns, 512);
  std::vector<uint16_t> read(labels.size());
  ASSERT_EQ(band.RasterIO(GF_Read, 0, 0, kWidth, kHeight, read.data(), kWidth, kHeight, GDT_UInt16, 0, 0, nullptr), CE_None);
  EXPECT_TRUE(read == labels);
  ASSERT_EQ(band.GetOverviewCount(), 2);
  for (int i = 0; i < 2; ++i) {
    GDALRasterBand& overview = *band.GetOverview(i);
    const int width = overview.GetXSize(), height = overview.GetYSize();
    std::vector<uint16_t> values(static_cast<size_t>(width) * static_cast<size_t>(height));
    ASSERT_EQ(overview.RasterIO(GF_Read, 0, 0, width, height, values.data(), width, height, GDT_UInt16, 0, 0, nullptr), CE_None);
    for (const uint16_t value : values) ASSERT_TRUE(value == 0 || value == 65535 || (value % 10 == 2 && value < 200)) << value;
  }
  const image::ImageF whole = ReadReduced(folder_ / "labels.tif", 1 << 20).image;
  EXPECT_TRUE(std::isnan(*whole.At(5, 5)));
  EXPECT_EQ(*whole.At(0, 105), static_cast<float>(label(0, 105)));
}

// Readers see alpha, though the file has a mask instead.
TEST_F(GeoTiff, LossyColoursKeepTheirTransparency) {
  constexpr int kWidth = 1400, kHeight = 1300;
  const std::vector<uint8_t> rgba = DiscOfColours(kWidth, kHeight);
  GeoTiffSpec spec = ColourSpec(kWidth, kHeight);
  spec.jpeg_quality = 90;
  GeoTiffWriter writer(folder_ / "map.tif", spec);
  writer.WriteRows(0, kHeight, std::span<const uint8_t>(rgba));
  writer.Close();
  const OpenedDataset map = OpenDataset(folder_ / "map.tif", GDAL_OF_RASTER);
  ASSERT_NE(map, nullptr);
  EXPECT_EQ(Item(map.get(), "COMPRESSION", "IMAGE_STRUCTURE"), "YCbCr JPEG");
  EXPECT_EQ(map->GetRasterCount(), 3);
  const image::ImageF whole = ReadReduced(folder_ / "map.tif", kWidth).image;
  ASSERT_EQ(whole.channels, 4);
  double sum = 0.0;
  size_t shown = 0;
  for (size_t i = 0; i < rgba.size(); i += 4) {
    ASSERT_EQ(whole.data[i + 3], static_cast<float>(rgba[i + 3]));
    if (rgba[i + 3] == 0) continue;
    ++shown;
    for (size_t c = 0; c < 3; ++c) sum += std::abs(static_cast<double>(whole.data[i + c]) - rgba[i + c]);
  }
  EXPECT_LT(sum / (3.0 * static_cast<double>(shown)), 3.0);
  const image::ImageF small = ReadReduced(folder_ / "map.tif", 140).image;
  ASSERT_EQ(small.channels, 4);
  EXPECT_EQ(small.At(2, 2)[3], 0.0F);
  EXPECT_EQ(small.At(70, 65)[3], 255.0F);
  EXPECT_NEAR(small.At(70, 65)[0], 100.0F, 4.0F);
  const MapGrid grid = spec.grid;
  const image::ImageF part = ReadMapPart(folder_ / "map.tif", {grid.CellCentre(350, 1000), grid.CellCentre(1050, 300)}, 70, 70);
  ASSERT_EQ(part.channels, 4);
  EXPECT_EQ(part.At(35, 35)[3], 255.0F);
  EXPECT_NEAR(part.At(35, 35)[0], 100.0F, 4.0F);
  EXPECT_THROW(GeoTiffWriter(folder_ / "heights.tif",
                             [] {
                               GeoTiffSpec heights = HeightSpec(10, 10);
                               heights.jpeg_quality = 90;
                               return heights;
                             }()),
               std::logic_error);
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
  ASSERT_EQ(band.GetOverviewCount(), 2);
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
