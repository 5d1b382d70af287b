#include "core/gis/boundary.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/core/gis/made_rings.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::gis {
namespace {

// 100 x 80 m with a hole of 20 x 20 m, easting and northing.
const Rings kYard = {{{430000, 4580000}, {430100, 4580000}, {430100, 4580080}, {430000, 4580080}},
                     {{430040, 4580030}, {430060, 4580030}, {430060, 4580050}, {430040, 4580050}}};

std::string Feature(const std::string& type, const std::string& coordinates) {
  return R"({"type":"Feature","properties":{},"geometry":{"type":")" + type + R"(","coordinates":)" + coordinates + "}}";
}

std::string Collection(const std::string& features) {
  return R"({"type":"FeatureCollection","features":[)" + features + "]}";
}

// A GeoPackage with one polygon per ring list; epsg 0: without CRS.
void WritePackage(const std::filesystem::path& file, const std::vector<Rings>& polygons, int epsg) {
  GDALAllRegister();
  GDALDataset* dataset = GetGDALDriverManager()->GetDriverByName("GPKG")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  OGRSpatialReference reference;
  if (epsg > 0) reference.importFromEPSG(epsg);
  OGRLayer* layer = dataset->CreateLayer("area", epsg > 0 ? &reference : nullptr, wkbUnknown, nullptr);
  for (const Rings& rings : polygons) {
    OGRPolygon polygon;
    for (const auto& points : rings) {
      OGRLinearRing ring;
      for (const Eigen::Vector2d& point : points) ring.addPoint(point.x(), point.y());
      ring.closeRings();
      polygon.addRing(&ring);
    }
    OGRFeature feature(layer->GetLayerDefn());
    feature.SetGeometry(&polygon);
    EXPECT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
  }
  GDALClose(dataset);
}

void ExpectYard(const Boundary& boundary) {
  EXPECT_TRUE(boundary.Contains({430010.0, 4580010.0}));
  EXPECT_TRUE(boundary.Contains({430099.9, 4580079.9}));
  EXPECT_FALSE(boundary.Contains({430050.0, 4580040.0})) << "in the hole";
  EXPECT_FALSE(boundary.Contains({430100.1, 4580010.0}));
  EXPECT_FALSE(boundary.Contains({430050.0, 4579999.9}));
  EXPECT_NEAR((boundary.min() - Eigen::Vector2d(430000, 4580000)).norm(), 0.0, 0.01);
  EXPECT_NEAR((boundary.max() - Eigen::Vector2d(430100, 4580080)).norm(), 0.0, 0.01);
}

TEST(Boundary, GeoJsonAndGeoPackageAgree) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "yard.geojson", Collection(Feature("Polygon", InDegrees(kYard))));
  WritePackage(folder / "yard.gpkg", {kYard}, 32631);
  const Boundary json = Boundary::Read(folder / "yard.geojson", true, kMade31N);
  const Boundary package = Boundary::Read(folder / "yard.gpkg", true, kMade31N);
  ExpectYard(json);
  ExpectYard(package);
  EXPECT_EQ(json.rings().size(), 2U);
}

TEST(Boundary, AxesOfLatitudeFirstSystemsAreRight) {
  // EPSG:25831 is UTM on ETRS89; EPSG:4258 and EPSG:3035 have latitude and northing first.
  const TemporaryFolder folder;
  OGRSpatialReference utm, laea;
  utm.importFromEPSG(32631);
  laea.importFromEPSG(3035);
  utm.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  laea.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  OGRCoordinateTransformation* to_laea = OGRCreateCoordinateTransformation(&utm, &laea);
  ASSERT_NE(to_laea, nullptr);
  Rings moved = kYard;
  for (auto& ring : moved) {
    for (Eigen::Vector2d& point : ring) ASSERT_TRUE(to_laea->Transform(1, &point.x(), &point.y()));
  }
  OCTDestroyCoordinateTransformation(to_laea);
  WritePackage(folder / "yard.gpkg", {moved}, 3035);
  ExpectYard(Boundary::Read(folder / "yard.gpkg", true, kMade31N));
}

TEST(Boundary, OverlappingPolygonsDoNotCancel) {
  const TemporaryFolder folder;
  const Rings west = {{{0, 0}, {60, 0}, {60, 50}, {0, 50}}};
  const Rings east = {{{40, 0}, {100, 0}, {100, 50}, {40, 50}}};
  WritePackage(folder / "two.gpkg", {west, east}, 32631);
  const Boundary boundary = Boundary::Read(folder / "two.gpkg", true, kMade31N);
  EXPECT_TRUE(boundary.Contains({50.0, 25.0}));
  EXPECT_TRUE(boundary.Contains({10.0, 25.0}));
  EXPECT_TRUE(boundary.Contains({90.0, 25.0}));
}

TEST(Boundary, MultiPolygonsAndCollectionsAreRead) {
  const TemporaryFolder folder;
  const Rings island = {{{430200, 4580000}, {430210, 4580000}, {430210, 4580010}}};
  base::WriteFileAtomically(folder / "multi.json", Collection(Feature("Point", "[2.1,41.3]") + "," +
                                                              Feature("MultiPolygon", "[" + InDegrees(kYard) + "," + InDegrees(island) + "]")));
  const Boundary boundary = Boundary::Read(folder / "multi.json", true, kMade31N);
  EXPECT_TRUE(boundary.Contains({430010.0, 4580010.0}));
  EXPECT_FALSE(boundary.Contains({430050.0, 4580040.0}));
  EXPECT_TRUE(boundary.Contains({430208.0, 4580004.0}));
  EXPECT_FALSE(boundary.Contains({430150.0, 4580004.0}));
}

TEST(Boundary, LocalMetresAreTakenAsTheyAre) {
  const TemporaryFolder folder;
  const std::string square = "[[[-500,-500],[700,-500],[700,900],[-500,900],[-500,-500]]]";
  base::WriteFileAtomically(folder / "local.geojson", Collection(Feature("Polygon", square)));
  const Boundary boundary = Boundary::Read(folder / "local.geojson", false, {});
  EXPECT_TRUE(boundary.Contains({699.0, 899.0}));
  EXPECT_FALSE(boundary.Contains({701.0, 0.0}));
  const std::string error = InputErrorOf([&] { Boundary::Read(folder / "local.geojson", true, kMade31N); });
  EXPECT_NE(error.find("no longitude and latitude"), std::string::npos) << error;
}

TEST(Boundary, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& name) { return InputErrorOf([&] { Boundary::Read(folder / name, true, kMade31N); }); };
  EXPECT_NE(error_of("none.geojson").find("none.geojson: does not exist"), std::string::npos);
  base::WriteFileAtomically(folder / "text.geojson", "hello");
  EXPECT_NE(error_of("text.geojson").find("cannot be read as GeoJSON or GeoPackage"), std::string::npos);
  EXPECT_NE(error_of(".").find("cannot be read as GeoJSON or GeoPackage"), std::string::npos);
  base::WriteFileAtomically(folder / "empty.gpkg", "");
  EXPECT_NE(error_of("empty.gpkg").find("cannot be read as GeoJSON or GeoPackage"), std::string::npos);
  base::WriteFileAtomically(folder / "line.geojson", Collection(Feature("LineString", "[[2,41],[2.1,41],[2.1,41.1]]")));
  EXPECT_NE(error_of("line.geojson").find("has no polygon"), std::string::npos);
  base::WriteFileAtomically(folder / "flat.geojson", Collection(Feature("Polygon", "[[[2,41],[2,41],[2,41],[2,41]]]")));
  EXPECT_NE(error_of("flat.geojson").find("has no polygon"), std::string::npos);
  WritePackage(folder / "nowhere.gpkg", {kYard}, 0);
  EXPECT_NE(error_of("nowhere.gpkg").find("without a coordinate reference system"), std::string::npos) << error_of("nowhere.gpkg");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  WritePackage(folder / "nan.gpkg", {{{{0, 0}, {1, nan}, {1, 1}}}}, 32631);
  EXPECT_NE(error_of("nan.gpkg").find("not a finite number"), std::string::npos) << error_of("nan.gpkg");
  WritePackage(folder / "far.gpkg", {{{{1e12, 1e12}, {2e12, 1e12}, {2e12, 2e12}}}}, 3035);
  EXPECT_NE(error_of("far.gpkg").find("cannot be transformed"), std::string::npos) << error_of("far.gpkg");
}

TEST(Boundary, WithoutRingsNothingIsInside) {
  const Boundary nothing(Rings{});
  EXPECT_FALSE(nothing.Contains({0.0, 0.0}));
  const MapGrid grid = {.georeferenced = false, .zone = {}, .left = 0.0, .top = 10.0, .resolution_m = 1.0, .width = 10, .height = 10};
  EXPECT_EQ(nothing.Mask(grid), std::vector<uint8_t>(100, 0));
  EXPECT_TRUE(Boundary(Rings{{{0, 0}, {5, 5}}}).rings().empty());
  const Boundary level(Rings{{{0, 5}, {5, 5}, {9, 5}}});
  EXPECT_FALSE(level.Contains({4.0, 5.0}));
  EXPECT_EQ(level.Mask(grid), std::vector<uint8_t>(100, 0));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Boundary(kYard).Contains({nan, 4580010.0}));
  EXPECT_FALSE(Boundary(kYard).Contains({430010.0, nan}));
}

TEST(Boundary, MaskOfKnownAreaIsExact) {
  // Corners at cell centres, so that every centre on the border must be counted for one side exactly once.
  const MapGrid grid = {.georeferenced = false, .zone = {}, .left = 0.0, .top = 20.0, .resolution_m = 1.0, .width = 30, .height = 20};
  const std::vector<uint8_t> mask = Boundary(Rings{{{2.5, 3.5}, {12.5, 3.5}, {12.5, 9.5}, {2.5, 9.5}}}).Mask(grid);
  int cells = 0;
  for (const uint8_t cell : mask) cells += cell;
  EXPECT_EQ(cells, 60);
  // Two areas that share a border cover each cell once.
  const std::vector<uint8_t> other = Boundary(Rings{{{12.5, 3.5}, {20.5, 3.5}, {20.5, 9.5}, {12.5, 9.5}}}).Mask(grid);
  for (size_t i = 0; i < mask.size(); ++i) EXPECT_LE(mask[i] + other[i], 1);
}

RC_GTEST_PROP(Boundary, MaskIsContainsOfEachCentre, ()) {
  const auto n_rings = *rc::gen::inRange(1, 5);
  Rings rings;
  for (int i = 0; i < n_rings; ++i) {
    const auto n_points = *rc::gen::inRange(3, 60);
    std::vector<Eigen::Vector2d> ring;
    // Whole and half metres: many points and edges lie exactly on centres and rows.
    for (int k = 0; k < n_points; ++k) ring.emplace_back(0.5 * *rc::gen::inRange(-10, 60), 0.5 * *rc::gen::inRange(-10, 60));
    rings.push_back(ring);
  }
  const Boundary boundary(rings);
  const MapGrid grid = {.georeferenced = false, .zone = {}, .left = 1.0, .top = 27.0, .resolution_m = 1.0, .width = 23, .height = 25};
  const std::vector<uint8_t> mask = boundary.Mask(grid);
  RC_ASSERT(mask.size() == 23U * 25U);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Eigen::Vector2d centre = grid.CellCentre(column, row);
      // Straight over all edges, without the lists of bands.
      bool inside = false;
      for (const auto& ring : boundary.rings()) {
        for (size_t i = 0; i < ring.size(); ++i) {
          const bool up = ring[i].y() < ring[(i + 1) % ring.size()].y();
          const Eigen::Vector2d low = up ? ring[i] : ring[(i + 1) % ring.size()];
          const Eigen::Vector2d high = up ? ring[(i + 1) % ring.size()] : ring[i];
          if (centre.y() < low.y() || centre.y() >= high.y()) continue;
          if (centre.x() < low.x() + (centre.y() - low.y()) / (high.y() - low.y()) * (high.x() - low.x())) inside = !inside;
        }
      }
      RC_ASSERT(boundary.Contains(centre) == inside);
      RC_ASSERT((mask[static_cast<size_t>(row * grid.width + column)] == 1) == inside);
    }
  }
}

}  // namespace
}  // namespace skyquilt::gis
