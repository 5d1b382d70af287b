#include "products/map_products.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/enu_frame.h"
#include "core/geo/geoid.h"
#include "core/image/image.h"
#include "products/height_shift.h"
#include "products/place_metadata.h"
#include "tests/products/analytic_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::products {
namespace {

class MapProductsTest : public InTemporaryFolder {
 protected:
  AnalyticScene scene_;
};

// Reads the file like another program: with GDAL's geo-transform, CRS and PROJ instead of our projections.
class OtherProgram {
 public:
  explicit OtherProgram(const std::filesystem::path& file) {
    GDALAllRegister();
    dataset_ = GDALDataset::Open(file.c_str(), GDAL_OF_RASTER);
    if (dataset_ != nullptr) dataset_->GetGeoTransform(transform_);
  }
  ~OtherProgram() {
    if (dataset_ != nullptr) GDALClose(dataset_);
  }
  OtherProgram(const OtherProgram&) = delete;
  OtherProgram& operator=(const OtherProgram&) = delete;

  GDALDataset* dataset() const { return dataset_; }
  // Column and row (fractional, outer corner 0) of a position on Earth.
  Eigen::Vector2d PixelOf(double longitude_deg, double latitude_deg) const {
    OGRSpatialReference wgs84;
    wgs84.importFromEPSG(4326);
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    OGRSpatialReference map(*dataset_->GetSpatialRef());
    map.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    OGRCoordinateTransformation* to_map = OGRCreateCoordinateTransformation(&wgs84, &map);
    double x = longitude_deg;
    double y = latitude_deg;
    EXPECT_TRUE(to_map != nullptr && to_map->Transform(1, &x, &y));
    OCTDestroyCoordinateTransformation(to_map);
    return {(x - transform_[0]) / transform_[1], (y - transform_[3]) / transform_[5]};
  }
  std::vector<float> Band(int band) const {
    std::vector<float> values(static_cast<size_t>(Width()) * static_cast<size_t>(Height()));
    EXPECT_EQ(dataset_->GetRasterBand(band)->RasterIO(GF_Read, 0, 0, Width(), Height(), values.data(), Width(), Height(), GDT_Float32, 0, 0),
              CE_None);
    return values;
  }
  int Width() const { return dataset_->GetRasterXSize(); }
  int Height() const { return dataset_->GetRasterYSize(); }
  const double* transform() const { return transform_; }

 private:
  GDALDataset* dataset_ = nullptr;
  double transform_[6] = {};
};

TEST(MapProducts, AreTheSameHoweverManyRaysACallGets) {
  const TemporaryFolder folder;
  const AnalyticScene scene;
  const scene::SceneInfo info = scene.Info({46.0, 7.5, 500.0}, true);
  size_t most = 0;
  const RayCaster caster = [&, cast = scene.Caster()](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    most = std::max(most, rays.size());
    cast(rays, out);
  };
  const MapProducts few = MakeMapProducts(info, caster, ProductOptions{}, folder / "few", nullptr, 1001);
  EXPECT_EQ(most, 1001U);
  const MapProducts many = MakeMapProducts(info, caster, ProductOptions{}, folder / "many", nullptr, RaysPerCall(64));
  EXPECT_GT(most, 1001U);
  EXPECT_EQ(few.rays, many.rays);
  for (int band = 1; band <= 4; ++band) EXPECT_EQ(OtherProgram(few.orthophoto).Band(band), OtherProgram(many.orthophoto).Band(band));
  EXPECT_EQ(OtherProgram(few.dsm).Band(1), OtherProgram(many.dsm).Band(1));
}

class AnywhereOnEarth : public testing::TestWithParam<geo::Geodetic> {};

TEST_P(AnywhereOnEarth, PlacesAndHeightsAreRight) {
  const TemporaryFolder folder;
  const AnalyticScene scene;
  const scene::SceneInfo info = scene.Info(GetParam(), true);
  const MapProducts products = MakeMapProducts(info, scene.Caster(), ProductOptions{}, folder.path());
  EXPECT_DOUBLE_EQ(products.grid.resolution_m, 0.5);
  EXPECT_DOUBLE_EQ(products.filled, 1.0);
  const OtherProgram ortho(products.orthophoto);
  const OtherProgram dsm(products.dsm);
  ASSERT_NE(ortho.dataset(), nullptr);
  ASSERT_NE(dsm.dataset(), nullptr);
  EXPECT_EQ(ortho.dataset()->GetRasterCount(), 4);
  EXPECT_EQ(ortho.dataset()->GetRasterBand(4)->GetColorInterpretation(), GCI_AlphaBand);
  EXPECT_EQ(dsm.dataset()->GetRasterBand(1)->GetNoDataValue(), -9999.0);
  const std::vector<float> red = ortho.Band(1);
  const std::vector<float> green = ortho.Band(2);
  const std::vector<float> blue = ortho.Band(3);
  const std::vector<float> height = dsm.Band(1);
  const geo::EnuFrame frame(info.origin);
  int checked = 0;
  for (double x = -59.0; x < 60.0; x += 2.93) {
    for (double y = -49.0; y < 50.0; y += 2.71) {
      // Edges of the house fall between two cells.
      const bool near_edge =
          std::abs(x) < 1.0 || std::abs(x - 10) < 1.0 || std::abs(x - 40) < 1.0 || std::abs(y + 20) < 1.0 || std::abs(y - 10) < 1.0;
      if (near_edge) continue;
      const geo::Geodetic place = frame.GeodeticFromEnu({x, y, scene.SurfaceZ(x, y)});
      const Eigen::Vector2d pixel = dsm.PixelOf(place.longitude_deg, place.latitude_deg);
      ASSERT_GE(pixel.minCoeff(), 0.0);
      ASSERT_LT(pixel.x(), dsm.Width());
      ASSERT_LT(pixel.y(), dsm.Height());
      const size_t cell = static_cast<size_t>(pixel.y()) * static_cast<size_t>(dsm.Width()) + static_cast<size_t>(pixel.x());
      EXPECT_NEAR(static_cast<double>(height[cell]), place.height_m, 0.01) << x << " " << y;
      const bool house = scene.InHouse(x, y);
      EXPECT_EQ(blue[cell], house ? 255.0F : 0.0F);
      EXPECT_EQ(red[cell], !house && x > 0 ? 255.0F : 0.0F);
      EXPECT_EQ(green[cell], !house && x < 0 ? 255.0F : 0.0F);
      ++checked;
    }
  }
  EXPECT_GT(checked, 800);
  // The map ends where the scene ends: its corners are within two cells of the outermost corners of the scene.
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  Eigen::Vector2d high = -low;
  for (const double x : {info.min_enu.x(), info.max_enu.x()}) {
    for (const double y : {info.min_enu.y(), info.max_enu.y()}) {
      const geo::Geodetic corner = frame.GeodeticFromEnu({x, y, scene.ground_z});
      const Eigen::Vector2d pixel = dsm.PixelOf(corner.longitude_deg, corner.latitude_deg);
      low = low.cwiseMin(pixel);
      high = high.cwiseMax(pixel);
    }
  }
  EXPECT_LT(low.cwiseAbs().maxCoeff(), 2.0);
  EXPECT_LT((high - Eigen::Vector2d(dsm.Width(), dsm.Height())).cwiseAbs().maxCoeff(), 2.0);
}

INSTANTIATE_TEST_SUITE_P(Places, AnywhereOnEarth,
                         testing::Values(geo::Geodetic{41.38, 2.17, 50.0}, geo::Geodetic{-33.86, 151.21, -20.0}, geo::Geodetic{0.0, 6.0, 0.0},
                                         geo::Geodetic{-17.0, 179.99999, 10.0}, geo::Geodetic{64.1, -21.9, 9000.0}, geo::Geodetic{78.2, 15.6, 40.0},
                                         geo::Geodetic{-54.8, -68.3, 5.0}, geo::Geodetic{89.9999, 10.0, 0.0}, geo::Geodetic{-90.0, 0.0, 2800.0}));

TEST_F(MapProductsTest, StayRightOverTensOfKilometres) {
  AnalyticScene scene;
  scene.house_min = {2000.0, -9000.0};
  scene.house_max = {12000.0, 3000.0};
  scene.roof_z = 600.0;
  scene::SceneInfo info = scene.Info({46.5, 7.9, 500.0}, true);
  info.gsd_m = 50.0;
  info.min_enu = {-15000.0, -15000.0, 0.0};
  info.max_enu = {15000.0, 15000.0, 610.0};
  info.blocks.resize(1);
  info.blocks[0].min_enu = info.min_enu;
  info.blocks[0].max_enu = info.max_enu;
  const MapProducts products = MakeMapProducts(info, scene.Caster(), ProductOptions{}, folder_.path());
  const OtherProgram dsm(products.dsm);
  const std::vector<float> height = dsm.Band(1);
  const geo::EnuFrame frame(info.origin);
  for (double x = -14000.0; x < 14500.0; x += 1310.0) {
    for (double y = -14000.0; y < 14500.0; y += 1270.0) {
      if (std::abs(x - 2000) < 200 || std::abs(x - 12000) < 200 || std::abs(y + 9000) < 200 || std::abs(y - 3000) < 200) continue;
      const geo::Geodetic place = frame.GeodeticFromEnu({x, y, scene.SurfaceZ(x, y)});
      const Eigen::Vector2d pixel = dsm.PixelOf(place.longitude_deg, place.latitude_deg);
      const auto column = static_cast<int>(pixel.x());
      const auto row = static_cast<int>(pixel.y());
      // A level plane of the local frame is not level on the ellipsoid, so compare at the centre of each cell.
      const Eigen::Vector2d en = products.grid.CellCentre(column, row);
      Eigen::Vector3d centre = frame.EnuFromGeodetic(geo::GeodeticFromUtm(en, place.height_m, products.grid.zone));
      centre.z() = scene.SurfaceZ(x, y);
      const double expected = frame.GeodeticFromEnu(centre).height_m;
      EXPECT_NEAR(static_cast<double>(height[static_cast<size_t>(row) * static_cast<size_t>(dsm.Width()) + static_cast<size_t>(column)]), expected,
                  0.02)
          << x << " " << y;
    }
  }
}

TEST_F(MapProductsTest, PlacesWithoutSurfaceHaveNoData) {
  AnalyticScene scene;
  scene.open_west = -30.0;
  const MapProducts products = MakeMapProducts(scene.Info({41.38, 2.17, 50.0}, true), scene.Caster(), ProductOptions{}, folder_.path());
  EXPECT_NEAR(products.filled, 0.75, 0.02);
  const std::vector<float> alpha = OtherProgram(products.orthophoto).Band(4);
  const std::vector<float> height = OtherProgram(products.dsm).Band(1);
  ASSERT_EQ(alpha.size(), height.size());
  size_t with_data = 0;
  for (size_t i = 0; i < alpha.size(); ++i) {
    EXPECT_EQ(alpha[i] > 0.0F, height[i] != -9999.0F);
    with_data += alpha[i] > 0.0F ? 1 : 0;
  }
  EXPECT_GT(with_data, alpha.size() / 2);
}

TEST_F(MapProductsTest, WithoutGeoReferenceTheyAreLocal) {
  const MapProducts products = MakeMapProducts(scene_.Info({}, false), scene_.Caster(), ProductOptions{}, folder_.path());
  const OtherProgram dsm(products.dsm);
  EXPECT_TRUE(dsm.dataset()->GetSpatialRef() == nullptr || dsm.dataset()->GetSpatialRef()->IsEmpty());
  EXPECT_EQ(dsm.transform()[0], -60.0);
  EXPECT_EQ(dsm.transform()[3], 50.0);
  EXPECT_EQ(dsm.Width(), 240);
  EXPECT_EQ(dsm.Height(), 200);
  const std::vector<float> height = dsm.Band(1);
  EXPECT_EQ(height[0], 5.0F);
  EXPECT_EQ(height[static_cast<size_t>(100) * 240 + 160], 25.0F);
}

// Metadata item of a file; empty when it has none.
std::string Item(const std::filesystem::path& file, const char* key) {
  const OtherProgram map(file);
  const char* value = map.dataset()->GetMetadataItem(key);
  return value == nullptr ? "" : value;
}

TEST_F(MapProductsTest, SayHowAccurateTheirPlaceIs) {
  scene::SceneInfo info = scene_.Info({41.38, 2.17, 50.0}, true);
  info.accuracy = {.scale_percent = 0.412345, .tilt_deg = 0.3, .yaw_deg = 0.25, .horizontal_m = 1.53};
  const MapProducts products = MakeMapProducts(info, scene_.Caster(), ProductOptions{}, folder_.path());
  for (const std::filesystem::path& file : {products.orthophoto, products.dsm}) {
    EXPECT_EQ(Item(file, "GEOREFERENCE"), "fitted to GPS tags");
    EXPECT_EQ(Item(file, "ACCURACY_SCALE_PERCENT"), "0.412");
    EXPECT_EQ(Item(file, "ACCURACY_TILT_DEG"), "0.3");
    EXPECT_EQ(Item(file, "ACCURACY_YAW_DEG"), "0.25");
    EXPECT_EQ(Item(file, "ACCURACY_HORIZONTAL_M"), "1.53");
    EXPECT_EQ(Item(file, "ACCURACY_VERTICAL_M"), "unknown");
    EXPECT_EQ(Item(file, "TIFFTAG_SOFTWARE"), "skyquilt");
  }
  EXPECT_EQ(Item(products.orthophoto, "TIFFTAG_IMAGEDESCRIPTION"),
            "Orthophoto, placed on Earth by its GPS tags with a standard deviation of 1.53 m horizontally, unknown vertically, 0.3 degrees in tilt, "
            "0.25 degrees in yaw, 0.412 % in scale.");
  EXPECT_EQ(Item(products.dsm, "VERTICAL_REFERENCE"), "unknown: the GPS tags have no usable heights");
  const auto map = base::ParseJson(base::ReadFile(folder_.path() / "orthophoto.json"));
  EXPECT_EQ(map["georeference"], "fitted to GPS tags");
  EXPECT_EQ(map["accuracy"]["scale_percent"], 0.412345);
  EXPECT_EQ(map["accuracy"]["horizontal_m"], 1.53);
  EXPECT_TRUE(map["accuracy"].at("vertical_m").is_null());
}

// A level scene 100 m above the ellipsoid, where the geoid is 48.411 m above it.
TEST_F(MapProductsTest, ConvertHeights) {
  scene::SceneInfo info = scene_.Info({52.0, -1.5, 100.0 - scene_.ground_z}, true);
  ProductOptions options;
  options.ortho = false;
  const auto ground = [&](const std::string& vertical) {
    options.vertical = vertical;
    const MapProducts products = MakeMapProducts(info, scene_.Caster(), options, folder_.path());
    const OtherProgram dsm(products.dsm);
    const Eigen::Vector2d pixel = dsm.PixelOf(-1.5, 52.0) + Eigen::Vector2d(-20.0, 20.0);  // the ground 14 m south-west of the origin
    return static_cast<double>(dsm.Band(1)[static_cast<size_t>(pixel.y()) * static_cast<size_t>(dsm.Width()) + static_cast<size_t>(pixel.x())]);
  };
  const std::filesystem::path dsm = folder_ / "dsm.tif";
  info.height_reference = geo::HeightReference::kEllipsoid;
  const double given = ground("as-tagged");
  EXPECT_NEAR(given, 100.0, 0.01);
  EXPECT_EQ(Item(dsm, "VERTICAL_REFERENCE"), "WGS84 ellipsoid (EPSG:4979)");
  EXPECT_STREQ(OtherProgram(dsm).dataset()->GetSpatialRef()->GetAuthorityCode(nullptr), "32630");
  EXPECT_EQ(ground("ellipsoid"), given);
  EXPECT_NEAR(ground("egm96"), given - 48.411, 2e-3);
  EXPECT_EQ(Item(dsm, "VERTICAL_REFERENCE"), "EGM96 geoid (EPSG:5773)");
  EXPECT_STREQ(OtherProgram(dsm).dataset()->GetSpatialRef()->GetAuthorityCode("VERT_CS"), "5773");
  info.height_reference = geo::HeightReference::kEgm96;
  EXPECT_EQ(ground("as-tagged"), given);
  EXPECT_EQ(ground("egm96"), given);
  EXPECT_NEAR(ground("ellipsoid"), given + 48.411, 2e-3);
  info.height_reference = geo::HeightReference::kUnknown;
  EXPECT_EQ(ground("as-tagged"), given);
  EXPECT_EQ(Item(dsm, "VERTICAL"), "as tagged (unknown)");
  EXPECT_NEAR(ground("egm96"), given - 48.411, 2e-3) << "taken for ellipsoidal";
  EXPECT_NE(Item(dsm, "VERTICAL_REFERENCE").find("if tagged heights are above the ellipsoid"), std::string::npos);
}

// In every cell, also of maps that are larger than the spacing of exact places, and where cells of the geoid's grid meet.
TEST(HeightShift, IsExactInEveryCell) {
  for (const geo::Geodetic& origin : {geo::Geodetic{27.999, 86.999, 0.0}, {-16.5, 180.0, 0.0}, {52.0, -1.5, 0.0}}) {
    scene::SceneInfo info;
    info.origin = origin;
    info.georeferenced = true;
    info.height_reference = geo::HeightReference::kEllipsoid;
    info.min_enu = Eigen::Vector3d(-500.0, -500.0, 0.0);
    info.max_enu = Eigen::Vector3d(500.0, 500.0, 10.0);
    const scene::MapHeights heights(info, geo::Vertical::kEgm96);
    gis::MapGrid grid{.georeferenced = true, .zone = geo::UtmZoneOf(origin), .left = 0, .top = 0, .resolution_m = 7.0, .width = 91, .height = 83};
    const Eigen::Vector2d middle = geo::UtmFromGeodetic(origin, grid.zone);
    grid.left = middle.x() - 300.0;
    grid.top = middle.y() + 300.0;
    std::vector<float> cells(grid.size(), 0.0F);
    cells[5] = -9999.0F;
    HeightShift shift(heights, grid);
    const size_t half = cells.size() / 83 * 40;
    shift.AddTo(0, -9999.0F, std::span(cells).first(half));
    shift.AddTo(40, -9999.0F, std::span(cells).subspan(half));
    EXPECT_EQ(cells[5], -9999.0F);
    for (int row = 0; row < grid.height; ++row) {
      for (int column = 0; column < grid.width; ++column) {
        if (row == 0 && column == 5) continue;
        const geo::Geodetic place = geo::GeodeticFromUtm(grid.CellCentre(column, row), 0.0, grid.zone);
        const size_t cell = grid.Index(column, row);
        ASSERT_NEAR(static_cast<double>(cells[cell]), -geo::Egm96Undulation(place.latitude_deg, place.longitude_deg), 1e-5) << row << " " << column;
      }
    }
  }
}

TEST(PlaceMetadata, NamesTheGeoreference) {
  const geo::PlaceAccuracy unknown;
  const geo::PlaceAccuracy exact = {0.0, 0.0, 0.0, 0.0, 0.0};
  const geo::PlaceAccuracy fitted = {0.0, 0.0, 0.0, 0.02, 0.0};
  const geo::PlaceAccuracy level = {.tilt_deg = 2.0};
  const auto items = [](const geo::PlaceAccuracy& accuracy, bool georeferenced) {
    scene::SceneInfo info = AnalyticScene().Info({41.38, 2.17, 50.0}, georeferenced);
    info.accuracy = accuracy;
    return PlaceMetadata(info, "Map");
  };
  EXPECT_EQ(items(exact, true).at("GEOREFERENCE"), "exact (simulated)");
  EXPECT_EQ(items(exact, true).at("ACCURACY_VERTICAL_M"), "0");
  EXPECT_EQ(items(exact, true).at("TIFFTAG_IMAGEDESCRIPTION"), "Map of a simulated survey whose place on Earth is known exactly.");
  EXPECT_EQ(items(fitted, true).at("GEOREFERENCE"), "fitted to GPS tags");
  EXPECT_EQ(items(unknown, true).at("GEOREFERENCE"), "of unknown accuracy");
  EXPECT_EQ(items(unknown, true).at("TIFFTAG_IMAGEDESCRIPTION"), "Map, placed on Earth with unknown accuracy.");
  EXPECT_EQ(items(level, false).at("GEOREFERENCE"), "local frame");
  EXPECT_EQ(items(level, false).at("ACCURACY_TILT_DEG"), "2");
  EXPECT_EQ(items(level, false).at("ACCURACY_SCALE_PERCENT"), "unknown");
  EXPECT_EQ(items(level, false).at("TIFFTAG_IMAGEDESCRIPTION"), "Map in a local frame of unknown scale, without a place on Earth.");
  EXPECT_EQ(items({.scale_percent = 0.5}, false).at("TIFFTAG_IMAGEDESCRIPTION"),
            "Map in a local frame in metres, by scale bars, without a place on Earth.");
}

TEST_F(MapProductsTest, LargeMapsHaveOverviewsAndTiles) {
  ProductOptions options;
  options.resolution_m = 0.1;
  options.dsm = false;
  const MapProducts products = MakeMapProducts(scene_.Info({41.38, 2.17, 50.0}, true), scene_.Caster(), options, folder_.path());
  const OtherProgram ortho(products.orthophoto);
  EXPECT_GE(ortho.dataset()->GetRasterBand(1)->GetOverviewCount(), 2);
  int block_width = 0;
  int block_height = 0;
  ortho.dataset()->GetRasterBand(1)->GetBlockSize(&block_width, &block_height);
  EXPECT_EQ(block_width, 512);
  EXPECT_EQ(block_height, 512);
  EXPECT_STREQ(ortho.dataset()->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
  EXPECT_TRUE(products.dsm.empty());
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "dsm.tif"));
}

TEST_F(MapProductsTest, PreviewsLieInTheLocalFrame) {
  // Far from the zone's central meridian, map north and true north differ by two degrees.
  MakeMapProducts(scene_.Info({50.0, 5.9, 50.0}, true), scene_.Caster(), ProductOptions{}, folder_.path());
  const image::Image8 picture = image::LoadRgb8(folder_.path() / "orthophoto.png");
  const auto bounds = base::ParseJson(base::ReadFile(folder_.path() / "orthophoto.json"));
  EXPECT_EQ(bounds["min_enu"][0], -60.0);
  EXPECT_EQ(bounds["max_enu"][1], 50.0);
  EXPECT_EQ(bounds["crs"], "EPSG:32631");
  ASSERT_EQ(picture.width, 240);
  ASSERT_EQ(picture.height, 200);
  int wrong = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double east = -60.0 + (x + 0.5) * 0.5;
      const double north = 50.0 - (y + 0.5) * 0.5;
      const bool near_edge = std::abs(east) < 1 || std::abs(east - 10) < 1 || std::abs(east - 40) < 1 || std::abs(north + 20) < 1 ||
                             std::abs(north - 10) < 1 || std::abs(east) > 59 || std::abs(north) > 49;
      if (near_edge) continue;
      const int channel = scene_.InHouse(east, north) ? 2 : east > 0 ? 0 : 1;
      if (picture.At(x, y)[channel] != 255 || picture.At(x, y)[(channel + 1) % 3] != 0) ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0);
  const image::Image8 relief = image::LoadRgb8(folder_.path() / "dsm.png");
  EXPECT_EQ(relief.width, 240);
}

TEST_F(MapProductsTest, TooManyCellsAreRefusedOrCoarsened) {
  const scene::SceneInfo info = scene_.Info({41.38, 2.17, 50.0}, true);
  ProductOptions options;
  options.max_pixels = 20000;
  const gis::MapGrid coarse = PlanMapGrid(info, options);
  EXPECT_LE(static_cast<double>(coarse.width) * coarse.height, 20000.0);
  EXPECT_GT(coarse.resolution_m, 0.5);
  options.resolution_m = 0.25;
  const std::string error = UsageErrorOf([&] { PlanMapGrid(info, options); });
  EXPECT_NE(error.find("set it to at least 1.0"), std::string::npos) << error;
  // By default automatic maps of the scene have fewer cells than requested ones may have.
  options = {};
  scene::SceneInfo fine = info;
  fine.gsd_m = 0.01;
  const gis::MapGrid automatic = PlanMapGrid(fine, options);
  EXPECT_LE(static_cast<double>(automatic.width) * automatic.height, kMostRenderedCells);
  EXPECT_DOUBLE_EQ(automatic.resolution_m, 0.05);
  options.resolution_m = 0.01;
  EXPECT_DOUBLE_EQ(PlanMapGrid(fine, options).resolution_m, 0.01);
  options.resolution_m = -1.0;
  EXPECT_THROW(PlanMapGrid(info, options), base::UsageError);
  options.resolution_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PlanMapGrid(info, options), base::UsageError);
}

TEST_F(MapProductsTest, RaysStayInTheBoxesAboveTheirCell) {
  scene::SceneInfo info = scene_.Info({41.38, 2.17, 50.0}, true);
  info.blocks[0].max_enu.z() = 8.0;
  const gis::MapGrid grid = PlanMapGrid(info, ProductOptions{});
  const MapRayGenerator generator(info, grid);
  MapRays rays;
  generator.MakeRow(grid.height / 2, &rays);
  ASSERT_GT(rays.rays.size(), 200U);
  for (const render::Ray& ray : rays.rays) {
    EXPECT_NEAR(ray.direction_enu.norm(), 1.0, 1e-12);
    const double top = ray.origin_enu.x() < -3.0 ? 8.0 : 27.0;
    EXPECT_NEAR(ray.origin_enu.z(), top, 1e-6);
    EXPECT_NEAR(ray.origin_enu.z() + ray.t_far * ray.direction_enu.z(), 3.0, 1e-6);
  }
}

TEST_F(MapProductsTest, RaysAreColumnsAsWideAsTheirCell) {
  for (const bool georeferenced : {true, false}) {
    const scene::SceneInfo info = scene_.Info({41.38, 2.17, 50.0}, georeferenced);
    ProductOptions options;
    options.resolution_m = 0.75;
    const gis::MapGrid grid = PlanMapGrid(info, options);
    MapRays rays;
    MapRayGenerator(info, grid).MakeRow(grid.height / 2, &rays);
    ASSERT_GT(rays.rays.size(), 100U);
    for (const render::Ray& ray : rays.rays) {
      EXPECT_EQ(ray.pixel_width, 0.75F);
      EXPECT_EQ(ray.pixel_pitch, 0.0F);
      EXPECT_EQ(ray.Footprint(ray.t_far), 0.75);
    }
  }
}

TEST_F(MapProductsTest, CancellingLeavesNoFileBehind) {
  ExpectStopsWhenAsked([&] { MakeMapProducts(scene_.Info({41.38, 2.17, 50.0}, true), scene_.Caster(), ProductOptions{}, folder_.path()); });
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST(NiceResolution, IsOneTwoOrFive) {
  EXPECT_DOUBLE_EQ(NiceResolution(0.46), 0.5);
  EXPECT_DOUBLE_EQ(NiceResolution(0.061), 0.05);
  EXPECT_DOUBLE_EQ(NiceResolution(0.13), 0.1);
  EXPECT_DOUBLE_EQ(NiceResolution(0.16), 0.2);
  EXPECT_DOUBLE_EQ(NiceResolution(8.0), 10.0);
  EXPECT_DOUBLE_EQ(NiceResolution(1.0), 1.0);
}

}  // namespace
}  // namespace skyquilt::products
