#include "surface/maps/surface_maps.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/gis/read_maps.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::surface {
namespace {

using SurfaceMapsTest = InTemporaryFolder;

scene::SceneInfo Info(bool georeferenced) {
  scene::SceneInfo info;
  info.georeferenced = georeferenced;
  info.height_reference = geo::HeightReference::kEllipsoid;
  info.origin = {41.38, 2.17, 50.0};
  info.min_enu = {-100.0, -100.0, 0.0};
  info.max_enu = {100.0, 100.0, 30.0};
  return info;
}

constexpr int kWidth = 320, kHeight = 240;
constexpr double kLeft = 430000.0, kTop = 4580000.0, kCell = 0.25;
double Ground(double x, double y) {
  return 60.0 + 0.08 * (x - kLeft) + 0.03 * (y - kTop);
}
bool House(double x, double y) {
  return std::abs(x - kLeft - 40.0) < 8.0 && std::abs(y - kTop + 30.0) < 6.0;
}
bool Unseen(double x, double y) {
  return x - kLeft > 70.0 && y - kTop > -10.0;
}

HeightRaster Surface(bool georeferenced) {
  HeightRaster raster;
  raster.grid = {
      .georeferenced = georeferenced, .zone = {31, true}, .left = kLeft, .top = kTop, .resolution_m = kCell, .width = kWidth, .height = kHeight};
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const Eigen::Vector2d at = raster.grid.CellCentre(column, row);
      raster.height_m.push_back(Unseen(at.x(), at.y()) ? std::numeric_limits<float>::quiet_NaN()
                                                       : static_cast<float>(Ground(at.x(), at.y()) + (House(at.x(), at.y()) ? 9.0 : 0.0)));
    }
  }
  return raster;
}

class OpenedFile {
 public:
  explicit OpenedFile(const std::filesystem::path& file) {
    GDALAllRegister();
    dataset_ = GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_VECTOR);
  }
  ~OpenedFile() {
    if (dataset_ != nullptr) GDALClose(dataset_);
  }
  OpenedFile(const OpenedFile&) = delete;
  OpenedFile& operator=(const OpenedFile&) = delete;
  GDALDataset* operator->() const { return dataset_; }
  std::vector<float> Values() const {
    std::vector<float> values(static_cast<size_t>(kWidth) * kHeight);
    EXPECT_EQ(dataset_->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, kWidth, kHeight, values.data(), kWidth, kHeight, GDT_Float32, 0, 0, nullptr),
              CE_None);
    return values;
  }
  std::string Item(const char* key, const char* domain = nullptr) const {
    const char* value = dataset_->GetMetadataItem(key, domain);
    return value == nullptr ? "" : value;
  }

 private:
  GDALDataset* dataset_ = nullptr;
};

TEST_F(SurfaceMapsTest, ShowGroundAndWhatStandsOnIt) {
  base::ThreadPool threads(2);
  const SurfaceMaps maps = MakeSurfaceMaps(Surface(true), MapFrame(Info(true)), std::nullopt, {}, folder_ / "maps", threads);
  const OpenedFile dtm(folder_ / "maps/dtm.tif"), above(folder_ / "maps/height_above_ground.tif"), shade(folder_ / "maps/hillshade.tif");
  for (const OpenedFile* map : {&dtm, &above, &shade}) {
    EXPECT_EQ(map->Item("LAYOUT", "IMAGE_STRUCTURE"), "COG");
    EXPECT_STREQ((*map)->GetSpatialRef()->GetAuthorityCode(nullptr), "32631");
    EXPECT_EQ((*map)->GetRasterBand(1)->GetOverviewCount(), 0) << "one tile";
  }
  EXPECT_EQ(dtm.Item("VERTICAL_REFERENCE"), "WGS84 ellipsoid (EPSG:4979)");
  EXPECT_STREQ(dtm->GetRasterBand(1)->GetUnitType(), "m");
  EXPECT_EQ(dtm->GetRasterBand(1)->GetNoDataValue(), -9999.0);
  EXPECT_EQ(shade->GetRasterBand(1)->GetNoDataValue(), 0.0);
  const std::vector<float> ground = dtm.Values(), height = above.Values(), light = shade.Values();
  const HeightRaster surface = Surface(true);
  for (size_t cell = 0; cell < ground.size(); ++cell) {
    const auto width = static_cast<size_t>(kWidth);
    const Eigen::Vector2d at = surface.grid.CellCentre(static_cast<double>(cell % width), static_cast<double>(cell / width));
    const bool unseen = Unseen(at.x(), at.y());
    // Gaps are filled in the ground only.
    EXPECT_EQ(height[cell] == -9999.0F, unseen);
    EXPECT_EQ(light[cell] == 0.0F, unseen);
    EXPECT_EQ(std::isnan(maps.terrain.height_m[cell]) ? -9999.0F : maps.terrain.height_m[cell], ground[cell]);
    if (unseen) continue;
    EXPECT_NEAR(ground[cell], Ground(at.x(), at.y()), 0.1);
    EXPECT_NEAR(height[cell], House(at.x(), at.y()) ? 9.0 : 0.0, 0.1);
  }
  const OpenedFile contours(folder_ / "maps/contours.gpkg");
  OGRLayer* layer = contours->GetLayerByName("contours");
  ASSERT_NE(layer, nullptr);
  EXPECT_STREQ(layer->GetSpatialRef()->GetAuthorityCode(nullptr), "32631");
  // 8.2 m of relief, of which the outermost per cent is not counted: 0.2 m between lines.
  EXPECT_GE(layer->GetFeatureCount(), 15);
  for (const auto& feature : *layer) {
    const double level = feature->GetFieldAsDouble("height_m");
    EXPECT_EQ(level, std::round(5.0 * level) / 5.0);
    const OGRLineString* line = feature->GetGeometryRef()->toLineString();
    const int middle = line->getNumPoints() / 2;
    EXPECT_NEAR(Ground(line->getX(middle), line->getY(middle)), level, 0.1);
  }

  ASSERT_EQ(maps.files.size(), 4U);
  for (const WrittenFile& file : maps.files) {
    EXPECT_EQ(file.bytes, static_cast<int64_t>(std::filesystem::file_size(folder_ / "maps" / file.file)));
    EXPECT_EQ(file.crs, "EPSG:32631");
  }
  EXPECT_EQ(maps.files[0].file, "dtm.tif");
  EXPECT_EQ(maps.files[0].format, "GeoTIFF (COG)");
  EXPECT_EQ(maps.files[0].detail, "cells of 0.25 m");
  EXPECT_NE(maps.files[3].detail.find("lines every 0.2 m"), std::string::npos);
}

TEST_F(SurfaceMapsTest, NameTheGeoidWhereHeightsAreAboveIt) {
  base::ThreadPool threads(2);
  MakeSurfaceMaps(Surface(true), MapFrame(Info(true), geo::Vertical::kEgm96), std::nullopt, {}, folder_.path(), threads);
  const OpenedFile dtm(folder_ / "dtm.tif"), above(folder_ / "height_above_ground.tif");
  EXPECT_STREQ(dtm->GetSpatialRef()->GetAuthorityCode("VERT_CS"), "5773");
  EXPECT_EQ(dtm.Item("VERTICAL_REFERENCE"), "EGM96 geoid (EPSG:5773)");
  EXPECT_STREQ(above->GetSpatialRef()->GetAuthorityCode(nullptr), "32631") << "no height above the geoid";
  EXPECT_EQ(gis::ReadUndulations(folder_ / "dtm.tif"), -1);
  EXPECT_EQ(gis::ReadUndulations(folder_ / "height_above_ground.tif"), 0);
  EXPECT_EQ(gis::ReadContours(folder_ / "contours.gpkg", 100000).undulations, -1);
}

TEST_F(SurfaceMapsTest, TheBoundaryCutsAllOfThem) {
  base::ThreadPool threads(1);
  const gis::Boundary boundary({{{kLeft + 10, kTop - 50}, {kLeft + 50, kTop - 50}, {kLeft + 30, kTop - 5}}});
  SurfaceOptions options;
  options.contour_interval_m = 0.25;
  MakeSurfaceMaps(Surface(true), MapFrame(Info(true)), boundary, options, folder_.path(), threads);
  const std::vector<uint8_t> mask = boundary.Mask(Surface(true).grid);
  for (const char* name : {"dtm.tif", "height_above_ground.tif", "hillshade.tif"}) {
    const OpenedFile map(folder_ / name);
    const auto no_data = static_cast<float>(map->GetRasterBand(1)->GetNoDataValue());
    const std::vector<float> values = map.Values();
    for (size_t cell = 0; cell < mask.size(); ++cell) EXPECT_EQ(values[cell] != no_data, mask[cell] != 0) << name;
  }
  const OpenedFile contours(folder_ / "contours.gpkg");
  OGREnvelope extent;
  ASSERT_EQ(contours->GetLayerByName("contours")->GetExtent(&extent), OGRERR_NONE);
  EXPECT_GT(extent.MinX, kLeft + 9.0);
  EXPECT_LT(extent.MaxX, kLeft + 51.0);
  EXPECT_LT(extent.MaxY, kTop - 4.0);
}

TEST_F(SurfaceMapsTest, WithoutGeoReferenceTheyHaveNoCrs) {
  base::ThreadPool threads(1);
  const SurfaceMaps maps = MakeSurfaceMaps(Surface(false), MapFrame(Info(false)), std::nullopt, {}, folder_.path(), threads);
  const OpenedFile dtm(folder_ / "dtm.tif");
  EXPECT_TRUE(dtm->GetSpatialRef() == nullptr || dtm->GetSpatialRef()->IsEmpty());
  EXPECT_EQ(dtm.Item("VERTICAL_REFERENCE"), "local frame");
  EXPECT_EQ(maps.files[0].crs, "local frame, metres");
}

TEST_F(SurfaceMapsTest, TheSameForAnyNumberOfThreads) {
  for (const int n : {1, 3}) {
    base::ThreadPool threads(n);
    MakeSurfaceMaps(Surface(true), MapFrame(Info(true)), std::nullopt, {}, folder_ / std::to_string(n), threads);
  }
  for (const char* name : {"dtm.tif", "height_above_ground.tif", "hillshade.tif", "contours.gpkg"}) {
    EXPECT_TRUE(base::ReadFile(folder_ / "1" / name) == base::ReadFile(folder_ / "3" / name)) << name;
  }
}

TEST_F(SurfaceMapsTest, EmptyFlatAndOneCell) {
  base::ThreadPool threads(1);
  const MapFrame frame(Info(true));
  EXPECT_TRUE(MakeSurfaceMaps({}, frame, std::nullopt, {}, folder_.path(), threads).files.empty());
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  HeightRaster nothing = Surface(true);
  std::fill(nothing.height_m.begin(), nothing.height_m.end(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(MakeSurfaceMaps(nothing, frame, std::nullopt, {}, folder_ / "nothing", threads).files.size(), 4U);
  HeightRaster flat = Surface(true);
  std::fill(flat.height_m.begin(), flat.height_m.end(), 12.34F);
  EXPECT_EQ(MakeSurfaceMaps(flat, frame, std::nullopt, {}, folder_ / "flat", threads).files[3].detail, "0 lines every 0.1 m");
  HeightRaster one = Surface(true);
  one.grid.width = one.grid.height = 1;
  one.height_m = {3.0F};
  EXPECT_EQ(MakeSurfaceMaps(one, frame, std::nullopt, {}, folder_ / "one", threads).files.size(), 4U);
}

TEST_F(SurfaceMapsTest, WithoutMapsOnlyTheTerrainIsFound) {
  base::ThreadPool threads(1);
  SurfaceOptions options;
  options.maps = false;
  const SurfaceMaps maps = MakeSurfaceMaps(Surface(true), MapFrame(Info(true)), std::nullopt, options, folder_ / "maps", threads);
  EXPECT_TRUE(maps.files.empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "maps"));
  EXPECT_FALSE(std::isnan(maps.terrain.height_m[static_cast<size_t>(kWidth) * 120 + 160]));
}

TEST_F(SurfaceMapsTest, FailuresLeaveNoPartialFile) {
  base::ThreadPool threads(1);
  base::WriteFileAtomically(folder_ / "file", "not a folder");
  const std::string error =
      InputErrorOf([&] { MakeSurfaceMaps(Surface(true), MapFrame(Info(true)), std::nullopt, {}, folder_ / "file/maps", threads); });
  EXPECT_NE(error, "");
  ExpectStopsWhenAsked([&] { MakeSurfaceMaps(Surface(true), MapFrame(Info(true)), std::nullopt, {}, folder_ / "maps", threads); });
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "maps"));
}

}  // namespace
}  // namespace skyquilt::surface
