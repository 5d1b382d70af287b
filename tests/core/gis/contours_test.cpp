#include "core/gis/contours.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/core/gis/open_dataset.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/limited_file_size.h"

namespace skyquilt::gis {
namespace {

using ContoursTest = InTemporaryFolder;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

MapGrid Grid(bool georeferenced = true) {
  return {.georeferenced = georeferenced, .zone = {17, false}, .left = 500000.0, .top = 7000000.0, .resolution_m = 0.5, .width = 120, .height = 90};
}

std::vector<float> Heights(const MapGrid& grid, const std::function<double(double, double)>& height) {
  std::vector<float> heights;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Eigen::Vector2d at = grid.CellCentre(column, row);
      heights.push_back(static_cast<float>(height(at.x() - grid.left, at.y() - grid.top)));
    }
  }
  return heights;
}

TEST_F(ContoursTest, LieAtMultiplesOfTheInterval) {
  const MapGrid grid = Grid();
  // 25 % to the east; the southern strip has no data.
  const auto plane = [](double x, double y) { return y < -40.0 ? std::nan("") : 97.03 + 0.25 * x; };
  const int64_t n = WriteContours(grid, Heights(grid, plane), 0.1, "WGS84 ellipsoid", folder_ / "contours.gpkg");
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) EXPECT_EQ(entry.path().filename(), "contours.gpkg");
  const OpenedDataset file = OpenDataset(folder_ / "contours.gpkg", GDAL_OF_VECTOR);
  ASSERT_NE(file, nullptr);
  OGRLayer* layer = file->GetLayerByName("contours");
  ASSERT_NE(layer, nullptr);
  EXPECT_EQ(layer->GetFeatureCount(), n);
  EXPECT_GE(n, 148);
  ASSERT_NE(layer->GetSpatialRef(), nullptr);
  EXPECT_STREQ(layer->GetSpatialRef()->GetAuthorityCode(nullptr), "32717");
  const char* description = layer->GetMetadataItem("DESCRIPTION");
  ASSERT_NE(description, nullptr);
  EXPECT_NE(std::string(description).find("WGS84 ellipsoid"), std::string::npos);
  double previous = 0.0;
  for (const auto& feature : *layer) {
    const double height = feature->GetFieldAsDouble("height_m");
    const auto tenths = std::lround(height * 10.0);
    EXPECT_EQ(height, static_cast<double>(tenths) / 10.0);
    EXPECT_EQ(feature->GetFieldAsInteger("index"), tenths % 5 == 0 ? 1 : 0);
    EXPECT_GE(height, previous);
    previous = height;
    const OGRLineString* line = feature->GetGeometryRef()->toLineString();
    for (int i = 0; i < line->getNumPoints(); ++i) {
      // The outermost half cells have the height of their centres.
      if (line->getX(i) > grid.left + 0.26 && line->getX(i) < grid.left + 59.74) {
        EXPECT_NEAR(97.03 + 0.25 * (line->getX(i) - grid.left), height, 1e-3);
      }
      EXPECT_LE(line->getY(i), grid.top);
      EXPECT_GE(line->getY(i), grid.top - 40.5);
    }
  }
}

TEST_F(ContoursTest, OfAConeAreClosedCircles) {
  const MapGrid grid = Grid(false);
  const auto cone = [](double x, double y) { return 10.0 - 0.5 * std::hypot(x - 30.0, y + 22.5); };
  EXPECT_GT(WriteContours(grid, Heights(grid, cone), 2.0, "local frame", folder_ / "contours.gpkg"), 3);
  const OpenedDataset file = OpenDataset(folder_ / "contours.gpkg", GDAL_OF_VECTOR);
  OGRLayer* layer = file->GetLayerByName("contours");
  EXPECT_TRUE(layer->GetSpatialRef() == nullptr || layer->GetSpatialRef()->IsLocal());
  for (const auto& feature : *layer) {
    const double height = feature->GetFieldAsDouble("height_m");
    if (height < 0.0) continue;
    const OGRLineString* line = feature->GetGeometryRef()->toLineString();
    EXPECT_TRUE(line->get_IsClosed());
    for (int i = 0; i < line->getNumPoints(); ++i)
      EXPECT_NEAR(std::hypot(line->getX(i) - 500030.0, line->getY(i) - 6999977.5), 20.0 - 2.0 * height, 0.1);
  }
}

TEST_F(ContoursTest, NothingToDrawGivesAnEmptyLayer) {
  const MapGrid grid = Grid();
  EXPECT_EQ(WriteContours(grid, std::vector<float>(120 * 90, 3.3F), 1.0, "", folder_ / "flat.gpkg"), 0);
  EXPECT_EQ(WriteContours(grid, std::vector<float>(120 * 90, kNone), 1.0, "", folder_ / "none.gpkg"), 0);
  MapGrid one = grid;
  one.width = one.height = 1;
  EXPECT_EQ(WriteContours(one, std::vector<float>{7.7F}, 0.5, "", folder_ / "one.gpkg"), 0);
  one.width = one.height = 0;
  EXPECT_EQ(WriteContours(one, {}, 0.5, "", folder_ / "zero.gpkg"), 0);
  std::vector<float> infinite(120 * 90, 1.0F);
  infinite[5000] = std::numeric_limits<float>::infinity();
  WriteContours(grid, infinite, 10.0, "", folder_ / "infinite.gpkg");
  for (const char* name : {"flat.gpkg", "none.gpkg", "one.gpkg", "zero.gpkg", "infinite.gpkg"}) {
    const OpenedDataset file = OpenDataset(folder_ / name, GDAL_OF_VECTOR);
    ASSERT_NE(file, nullptr) << name;
    ASSERT_NE(file->GetLayerByName("contours"), nullptr);
    EXPECT_EQ(file->GetLayerByName("contours")->GetFeatureCount(), 0) << name;
  }
}

TEST_F(ContoursTest, TooManyLevelsAreThinned) {
  const MapGrid grid = Grid();
  const auto steep = [](double x, double) { return 50.0 * x; };  // 3000 m
  const int64_t n = WriteContours(grid, Heights(grid, steep), 0.1, "", folder_ / "contours.gpkg");
  EXPECT_LE(n, 1000);
  EXPECT_GE(n, 500);
  const OpenedDataset file = OpenDataset(folder_ / "contours.gpkg", GDAL_OF_VECTOR);
  for (const auto& feature : *file->GetLayerByName("contours")) {
    const double height = feature->GetFieldAsDouble("height_m");
    EXPECT_NEAR(height / 5.0, std::round(height / 5.0), 1e-9);
  }
}

TEST_F(ContoursTest, TheSameRasterGivesTheSameBytes) {
  const MapGrid grid = Grid();
  const std::vector<float> waves = Heights(grid, [](double x, double y) { return std::sin(0.3 * x) * std::cos(0.2 * y); });
  WriteContours(grid, waves, 0.1, "here", folder_ / "a.gpkg");
  // Longer than the resolution of the time stamps.
  timespec wait = {.tv_sec = 0, .tv_nsec = 20'000'000};
  nanosleep(&wait, nullptr);
  WriteContours(grid, waves, 0.1, "here", folder_ / "b.gpkg");
  // Layers are not named after the file.
  EXPECT_TRUE(base::ReadFile(folder_ / "a.gpkg") == base::ReadFile(folder_ / "b.gpkg"));
}

TEST_F(ContoursTest, FailuresLeaveNothingBehind) {
  const MapGrid grid = Grid();
  const std::vector<float> waves = Heights(grid, [](double x, double y) { return std::sin(0.3 * x) * std::cos(0.2 * y); });
  const std::string missing = InputErrorOf([&] { WriteContours(grid, waves, 0.1, "", folder_ / "no_such_folder/contours.gpkg"); });
  EXPECT_NE(missing.find("contours.gpkg: cannot be created"), std::string::npos) << missing;
  {
    const LimitedFileSize full(60'000);
    const std::string error = InputErrorOf([&] { WriteContours(grid, waves, 0.1, "", folder_ / "contours.gpkg"); });
    EXPECT_NE(error.find("Check the free space"), std::string::npos) << error;
  }
  ExpectStopsWhenAsked([&] { WriteContours(grid, waves, 0.1, "", folder_ / "contours.gpkg"); });
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace skyquilt::gis
