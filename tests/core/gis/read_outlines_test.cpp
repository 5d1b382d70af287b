#include "core/gis/read_outlines.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/gis/vector_layers.h"
#include "tests/core/gis/made_rings.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::gis {
namespace {

using ReadOutlinesTest = InTemporaryFolder;

// The outer ring clockwise and the hole counter-clockwise, against the contract of the result.
const Rings kHouse = {{{430000, 4580000}, {430000, 4580080}, {430100, 4580080}, {430100, 4580000}},
                      {{430040, 4580030}, {430060, 4580030}, {430060, 4580050}, {430040, 4580050}}};
const Rings kShed = {{{430200, 4580000}, {430210, 4580000}, {430210, 4580010}}};

// head: members of the feature before its properties, for instance "\"id\":7,".
std::string OneFeature(const std::string& head, const std::string& properties, const std::string& type, const std::string& coordinates) {
  return R"({"type":"Feature",)" + head + R"("properties":{)" + properties + R"(},"geometry":{"type":")" + type + R"(","coordinates":)" +
         coordinates + "}}";
}

std::string Features(const std::string& features) {
  return R"({"type":"FeatureCollection","features":[)" + features + "]}";
}

double SignedArea(const Ring& ring) {
  double twice = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d a = ring[i] - ring[0], b = ring[(i + 1) % ring.size()] - ring[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

void ExpectHouse(const Outline& outline) {
  ASSERT_EQ(outline.rings.size(), 2U);
  ASSERT_EQ(outline.rings[0].size(), 4U);
  ASSERT_EQ(outline.rings[1].size(), 4U);
  EXPECT_NEAR(SignedArea(outline.rings[0]), 8000.0, 1.0) << "counter-clockwise";
  EXPECT_NEAR(SignedArea(outline.rings[1]), -400.0, 0.1) << "clockwise";
  double nearest = 1e9;
  for (const Eigen::Vector2d& point : outline.rings[0]) nearest = std::min(nearest, (point - kHouse[0][0]).norm());
  EXPECT_LT(nearest, 0.01);
}

std::vector<std::string> IdsOf(const std::vector<Outline>& outlines) {
  std::vector<std::string> ids;
  for (const Outline& outline : outlines) ids.push_back(outline.id);
  return ids;
}

// Shapefile in the given CRS; 0: without one.
void WriteShapefile(const std::filesystem::path& file, const Rings& rings, int epsg, const char* field, const char* value) {
  GDALAllRegister();
  GDALDataset* dataset = GetGDALDriverManager()->GetDriverByName("ESRI Shapefile")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  OGRSpatialReference reference;
  if (epsg > 0) reference.importFromEPSG(epsg);
  OGRLayer* layer = dataset->CreateLayer("houses", epsg > 0 ? &reference : nullptr, wkbPolygon, nullptr);
  OGRFieldDefn definition(field, OFTString);
  EXPECT_EQ(layer->CreateField(&definition), OGRERR_NONE);
  OGRPolygon polygon;
  for (const Ring& points : rings) {
    OGRLinearRing ring;
    for (const Eigen::Vector2d& point : points) ring.addPoint(point.x(), point.y());
    ring.closeRings();
    polygon.addRing(&ring);
  }
  OGRFeature feature(layer->GetLayerDefn());
  feature.SetGeometry(&polygon);
  feature.SetField(0, value);
  EXPECT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
  GDALClose(dataset);
}

VectorLayer LayerOf(const Rings& rings, std::vector<LayerField> fields, std::vector<FieldValue> values) {
  VectorLayer layer{.name = "houses", .description = "", .geometry = LayerGeometry::kPolygon, .fields = std::move(fields), .features = {}};
  LayerPolygon polygon;
  for (const Ring& ring : rings) {
    auto& points = polygon.emplace_back();
    for (const Eigen::Vector2d& point : ring) points.emplace_back(point.x(), point.y(), 0.0);
  }
  layer.features.push_back({{polygon}, std::move(values)});
  return layer;
}

TEST_F(ReadOutlinesTest, AllFormatsAgree) {
  base::WriteFileAtomically(folder_ / "houses.geojson", Features(OneFeature("", R"("id":"H7")", "Polygon", InDegrees(kHouse, ",7.5"))));
  WriteShapefile(folder_ / "houses.shp", kHouse, 32631, "ID", "H7");
  const VectorLayer layer = LayerOf(kHouse, {{"id", FieldType::kText}}, {std::string("H7")});
  WriteVectorLayers(std::span(&layer, 1), true, kMade31N, folder_ / "houses.gpkg");
  for (const char* name : {"houses.geojson", "houses.shp", "houses.gpkg"}) {
    const std::vector<Outline> outlines = ReadOutlines(folder_ / name, true, kMade31N);
    ASSERT_EQ(outlines.size(), 1U) << name;
    ExpectHouse(outlines[0]);
    EXPECT_EQ(outlines[0].id, "H7") << name;
  }
  // In a zone beside the survey's.
  const std::vector<Outline> beside = ReadOutlines(folder_ / "houses.gpkg", true, {32, true});
  EXPECT_LT(beside[0].rings[0][0].x(), 0.0) << "west of zone 32";
}

TEST_F(ReadOutlinesTest, MultipolygonsAreSplitAndKeepTheirId) {
  base::WriteFileAtomically(folder_ / "a.json", Features(OneFeature("", R"("a":1)", "Point", "[2.1,41.3]") + "," +
                                                         OneFeature("", R"("name":"two")", "MultiPolygon",
                                                                    "[" + InDegrees(kHouse, ",7.5") + "," + InDegrees(kShed, ",7.5") + "]") +
                                                         "," + OneFeature("", R"("name":null)", "Polygon", InDegrees(kShed, ",7.5"))));
  const std::vector<Outline> outlines = ReadOutlines(folder_ / "a.json", true, kMade31N);
  EXPECT_EQ(IdsOf(outlines), (std::vector<std::string>{"two", "two", ""}));
  ExpectHouse(outlines[0]);
  EXPECT_EQ(outlines[1].rings.size(), 1U);
  EXPECT_NEAR(SignedArea(outlines[1].rings[0]), 50.0, 0.1);
}

TEST_F(ReadOutlinesTest, FindTheIdentity) {
  const auto ids = [&](const std::string& features) {
    base::WriteFileAtomically(folder_ / "a.geojson", Features(features));
    return IdsOf(ReadOutlines(folder_ / "a.geojson", true, kMade31N));
  };
  const std::string shed = InDegrees(kShed, ",7.5");
  const auto feature = [&](const std::string& head, const std::string& properties) { return OneFeature(head, properties, "Polygon", shed); };
  EXPECT_EQ(ids(feature("", R"("name":"n","osm_id":12345678901,"fid":3,"id":4)")), std::vector<std::string>{"4"});
  EXPECT_EQ(ids(feature("", R"("name":"n","osm_id":12345678901)")), std::vector<std::string>{"12345678901"});
  EXPECT_EQ(ids(feature("", R"("name":"Café ⌂","osm_id":null)")), std::vector<std::string>{"Café ⌂"});
  EXPECT_EQ(ids(feature("", R"("ID":"","Name":"x")")), std::vector<std::string>{"x"});
  EXPECT_EQ(ids(feature(R"("id":"way/9",)", "")), std::vector<std::string>{"way/9"});
  EXPECT_EQ(ids(feature(R"("id":17,)", "") + "," + feature(R"("id":4,)", "")), (std::vector<std::string>{"17", "4"}));
  EXPECT_EQ(ids(feature("", R"("height":3)")), std::vector<std::string>{""});
  const VectorLayer layer = LayerOf(kShed, {{"name", FieldType::kText}}, {std::monostate()});
  WriteVectorLayers(std::span(&layer, 1), true, kMade31N, folder_ / "a.gpkg");
  EXPECT_EQ(IdsOf(ReadOutlines(folder_ / "a.gpkg", true, kMade31N)), std::vector<std::string>{"1"}) << "GeoPackage numbers its rows";
}

TEST_F(ReadOutlinesTest, TextsOfUnknownEncodingBecomeClean) {
  WriteShapefile(folder_ / "houses.shp", kShed, 32631, "name", "Caf\xE9");
  std::filesystem::remove(folder_ / "houses.cpg");
  const std::string id = ReadOutlines(folder_ / "houses.shp", true, kMade31N)[0].id;
  EXPECT_TRUE(id.starts_with("Caf")) << id;
  EXPECT_EQ(id.find('\xE9'), std::string::npos) << "a byte that is no UTF-8";
}

TEST_F(ReadOutlinesTest, RepairsPolygonsThatCrossThemselves) {
  const Rings bow = {{{430000, 4580000}, {430010, 4580010}, {430010, 4580000}, {430000, 4580010}}};
  base::WriteFileAtomically(folder_ / "a.geojson", Features(OneFeature("", R"("id":"bow")", "Polygon", InDegrees(bow, ",7.5"))));
  const std::vector<Outline> outlines = ReadOutlines(folder_ / "a.geojson", true, kMade31N);
  EXPECT_EQ(IdsOf(outlines), (std::vector<std::string>{"bow", "bow"}));
  for (const Outline& outline : outlines) {
    EXPECT_EQ(outline.rings[0].size(), 3U);
    EXPECT_NEAR(SignedArea(outline.rings[0]), 25.0, 0.1);
  }
}

TEST_F(ReadOutlinesTest, LocalMetresAreTakenAsTheyAre) {
  const std::string square = "[[[-500,-500],[700,-500],[700,-500],[700,900],[-500,900],[-500,-500]]]";
  base::WriteFileAtomically(folder_ / "local.geojson", Features(OneFeature("", "", "Polygon", square)));
  const std::vector<Outline> outlines = ReadOutlines(folder_ / "local.geojson", false, {});
  ASSERT_EQ(outlines.size(), 1U);
  EXPECT_EQ(outlines[0].rings, (Rings{{{-500, -500}, {700, -500}, {700, 900}, {-500, 900}}}));
}

TEST_F(ReadOutlinesTest, SaysWhatIsWrong) {
  const auto error_of = [&](const std::string& name) { return InputErrorOf([&] { ReadOutlines(folder_ / name, true, kMade31N); }); };
  EXPECT_NE(error_of("none.shp").find("none.shp: does not exist"), std::string::npos);
  base::WriteFileAtomically(folder_ / "text.geojson", "hello");
  EXPECT_NE(error_of("text.geojson").find("cannot be read as GeoJSON, GeoPackage or Shapefile"), std::string::npos);
  base::WriteFileAtomically(folder_ / "line.geojson", Features(OneFeature("", "", "LineString", "[[2,41],[2.1,41],[2.1,41.1]]")));
  EXPECT_NE(error_of("line.geojson").find("has no polygon with an area"), std::string::npos);
  base::WriteFileAtomically(folder_ / "flat.geojson", Features(OneFeature("", "", "Polygon", "[[[2,41],[2.1,41],[2,41],[2,41]]]")));
  EXPECT_NE(error_of("flat.geojson").find("has no polygon with an area"), std::string::npos);
  WriteShapefile(folder_ / "nowhere.shp", kShed, 0, "id", "1");
  EXPECT_NE(error_of("nowhere.shp").find("without a coordinate reference system"), std::string::npos) << error_of("nowhere.shp");
  base::WriteFileAtomically(folder_ / "metres.geojson", Features(OneFeature("", "", "Polygon", "[[[500,100],[600,100],[600,200],[500,100]]]")));
  EXPECT_NE(error_of("metres.geojson").find("no longitude and latitude"), std::string::npos);
}

TEST_F(ReadOutlinesTest, GiveBackWhatWasWritten) {
  // Stars around a middle cross nothing, whatever their radii.
  std::mt19937 random(7);
  const auto whole = [&](int min, int max) { return std::uniform_int_distribution<int>(min, max)(random); };
  std::vector<Ring> stars;
  VectorLayer layer = LayerOf(kShed, {{"id", FieldType::kInteger}}, {int64_t{0}});
  for (int64_t id = 1; id <= 200; ++id) {
    Ring& star = stars.emplace_back();
    for (int i = 0, corners = whole(3, 12); i < corners; ++i) {
      const double angle = 2.0 * 3.14159265358979 * i / corners, radius = 0.01 * whole(500, 3000);
      star.emplace_back(430000.0 + radius * std::cos(angle), 4580000.0 + radius * std::sin(angle));
    }
    layer.features.push_back(LayerOf({star}, {}, {id}).features[0]);
  }
  WriteVectorLayers(std::span(&layer, 1), true, kMade31N, folder_ / "stars.gpkg");
  const std::vector<Outline> outlines = ReadOutlines(folder_ / "stars.gpkg", true, kMade31N);
  ASSERT_EQ(outlines.size(), stars.size() + 1);
  for (size_t k = 0; k < stars.size(); ++k) {
    const Outline& found = outlines[k + 1];
    EXPECT_EQ(found.id, std::to_string(k + 1));
    ASSERT_EQ(found.rings.size(), 1U);
    ASSERT_EQ(found.rings[0].size(), stars[k].size());
    for (size_t i = 0; i < stars[k].size(); ++i) EXPECT_LT((found.rings[0][i] - stars[k][i]).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace skyquilt::gis
