// What files say of the heights in them, read back with GDAL.
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <array>

#include "core/base/errors.h"
#include "core/gis/contours.h"
#include "core/gis/geotiff.h"
#include "core/gis/read_maps.h"
#include "core/gis/vector_layers.h"
#include "core/gis/zone_wkt.h"
#include "tests/core/gis/open_dataset.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::gis {
namespace {

using MapsWithHeights = InTemporaryFolder;

using geo::HeightReference;

const std::array<geo::UtmZone, 4> kZones = {{{30, true}, {56, false}, {0, true}, {0, false}}};

MapGrid GridIn(const geo::UtmZone& zone) {
  return {.georeferenced = true, .zone = zone, .left = 600000.0, .top = 5700000.0, .resolution_m = 0.5, .width = 40, .height = 30};
}

void WriteMap(const geo::UtmZone& zone, HeightReference heights, const std::map<std::string, std::string>& metadata,
              const std::filesystem::path& file) {
  GeoTiffSpec spec;
  spec.grid = GridIn(zone);
  spec.type = PixelType::kFloat32;
  spec.heights = heights;
  spec.metadata = metadata;
  GeoTiffWriter writer(file, spec);
  writer.WriteRows(0, 30, std::span<const float>(std::vector<float>(1200, 51.589F)));
  writer.Close();
}

TEST_F(MapsWithHeights, NameTheirVerticalSystem) {
  for (const geo::UtmZone& zone : kZones) {
    const std::string code = std::to_string(zone.Epsg());
    WriteMap(zone, HeightReference::kEllipsoid, {}, folder_ / "ellipsoid.tif");
    const OpenedDataset ellipsoid = OpenDataset(folder_ / "ellipsoid.tif", GDAL_OF_RASTER);
    const OGRSpatialReference* crs = ellipsoid->GetSpatialRef();
    ASSERT_NE(crs, nullptr);
    EXPECT_STREQ(crs->GetAuthorityCode(nullptr), code.c_str());

    WriteMap(zone, HeightReference::kEgm96, {}, folder_ / "egm96.tif");
    const OpenedDataset egm96 = OpenDataset(folder_ / "egm96.tif", GDAL_OF_RASTER);
    crs = egm96->GetSpatialRef();
    ASSERT_NE(crs, nullptr);
    EXPECT_TRUE(crs->IsCompound()) << code;
    EXPECT_STREQ(crs->GetAuthorityCode("PROJCS"), code.c_str());
    EXPECT_STREQ(crs->GetAuthorityCode("VERT_CS"), "5773") << code;
    EXPECT_STREQ(crs->GetAttrValue("VERT_CS"), "EGM96 height") << code;

    WriteMap(zone, HeightReference::kUnknown, {}, folder_ / "unknown.tif");
    const OpenedDataset unknown = OpenDataset(folder_ / "unknown.tif", GDAL_OF_RASTER);
    EXPECT_EQ(unknown->GetSpatialRef()->GetAxesCount(), 2) << code;
    EXPECT_STREQ(unknown->GetSpatialRef()->GetAuthorityCode(nullptr), code.c_str());

    // The CRS is in the file itself.
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 3);
    // This program finds the zone again in all of them.
    for (const char* name : {"ellipsoid.tif", "egm96.tif", "unknown.tif"}) {
      EXPECT_EQ(ReadMapGrid(folder_ / name).zone.Epsg(), zone.Epsg()) << name;
      EXPECT_EQ(ReadUndulations(folder_ / name), 0);
    }
  }
}

// Another program that follows the CRS comes to the place that was meant.
TEST_F(MapsWithHeights, LeadToTheirPlaceInOtherPrograms) {
  const geo::UtmZone zone{30, true};
  const Eigen::Vector2d at = geo::UtmFromGeodetic({52.0, -1.5, 0.0}, zone);
  OGRSpatialReference wgs84;
  wgs84.importFromEPSG(4979);
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const struct {
    HeightReference heights;
    double height_m;
  } cases[] = {{HeightReference::kEllipsoid, 100.0}, {HeightReference::kEgm96, 51.589}};
  for (const auto& one : cases) {
    WriteMap(zone, one.heights, {}, folder_ / "map.tif");
    const OpenedDataset map = OpenDataset(folder_ / "map.tif", GDAL_OF_RASTER);
    OGRSpatialReference from(*map->GetSpatialRef());
    from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    OGRCoordinateTransformation* to_wgs84 = OGRCreateCoordinateTransformation(&from, &wgs84);
    ASSERT_NE(to_wgs84, nullptr);
    double x = at.x(), y = at.y(), z = one.height_m;
    EXPECT_TRUE(to_wgs84->Transform(1, &x, &y, &z));
    OCTDestroyCoordinateTransformation(to_wgs84);
    EXPECT_NEAR(x, -1.5, 1e-7);
    EXPECT_NEAR(y, 52.0, 1e-7);
    EXPECT_NEAR(z, 100.0, 1e-3);
  }
}

TEST_F(MapsWithHeights, SayHowTheyWereConverted) {
  for (const int undulations : {-1, 1}) {
    const std::map<std::string, std::string> metadata = {{geo::kUndulationsItem, std::to_string(undulations)}};
    WriteMap({30, true}, HeightReference::kEgm96, metadata, folder_ / "map.tif");
    EXPECT_EQ(ReadUndulations(folder_ / "map.tif"), undulations);
    std::vector<float> slope;
    for (int cell = 0; cell < 1200; ++cell) slope.push_back(static_cast<float>(0.1 * (cell % 40)));
    WriteContours(GridIn({30, true}), slope, 1.0, "EGM96", folder_ / "contours.gpkg", metadata);
    EXPECT_EQ(ReadContours(folder_ / "contours.gpkg", 1000).undulations, undulations);
  }
  WriteMap({30, true}, HeightReference::kEgm96, {{geo::kUndulationsItem, "2"}}, folder_ / "damaged.tif");
  EXPECT_THROW(ReadUndulations(folder_ / "damaged.tif"), base::InputError);
}

TEST(WktOfZone, NamesWhatHeightsAreAbove) {
  for (const geo::UtmZone& zone : kZones) {
    const std::string code = "AUTHORITY[\"EPSG\",\"" + std::to_string(zone.Epsg()) + "\"]";
    const std::string plain = WktOfZone(zone), egm96 = WktOfZone(zone, HeightReference::kEgm96);
    const std::string ellipsoid = WktOfZone(zone, HeightReference::kEllipsoid);
    EXPECT_TRUE(plain.starts_with("PROJCS[")) << plain;
    EXPECT_NE(plain.find(code), std::string::npos) << plain;
    EXPECT_TRUE(egm96.starts_with("COMPD_CS[")) << egm96;
    EXPECT_NE(egm96.find(code), std::string::npos) << egm96;
    EXPECT_NE(egm96.find("AUTHORITY[\"EPSG\",\"5773\"]"), std::string::npos) << egm96;
    EXPECT_TRUE(ellipsoid.starts_with("COMPD_CS[")) << ellipsoid;
    EXPECT_NE(ellipsoid.find("VERT_DATUM[\"Ellipsoid\",2002]"), std::string::npos) << ellipsoid;
  }
}

TEST(VectorLayersWithHeights, NameTheirVerticalSystem) {
  const TemporaryFolder folder;
  const LayerPolygon triangle = {{{600000.0, 5700000.0, 1.0}, {600010.0, 5700000.0, 2.0}, {600000.0, 5700010.0, 3.0}}};
  std::array<VectorLayer, 3> layers;
  const std::array<HeightReference, 3> references = {HeightReference::kEllipsoid, HeightReference::kEgm96, HeightReference::kUnknown};
  for (size_t i = 0; i < layers.size(); ++i) {
    layers[i] = {.name = geo::NameOf(references[i]),
                 .description = "",
                 .geometry = LayerGeometry::kMultiPolygonZ,
                 .heights = references[i],
                 .fields = {},
                 .features = {{.polygons = {triangle}, .values = {}}}};
  }
  WriteVectorLayers(layers, true, {30, true}, folder / "three.gpkg");
  const OpenedDataset file = OpenDataset(folder / "three.gpkg", GDAL_OF_VECTOR);
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(file->GetLayer(0)->GetSpatialRef()->GetAxesCount(), 3);
  EXPECT_STREQ(file->GetLayer(1)->GetSpatialRef()->GetAuthorityCode("VERT_CS"), "5773");
  EXPECT_STREQ(file->GetLayer(2)->GetSpatialRef()->GetAuthorityCode(nullptr), "32630");
}

}  // namespace
}  // namespace skyquilt::gis
