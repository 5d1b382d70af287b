#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/survey/geo_fit.h"
#include "partition/block.h"
#include "partition/lonlat_polygon.h"

namespace skyquilt::partition {
namespace {

using Json = nlohmann::json;

class TempFile {
 public:
  TempFile() {
    static int counter = 0;
    path_ = std::filesystem::temp_directory_path() / ("skyquilt_blocks_" + std::to_string(getpid()) + "_" + std::to_string(counter++) + ".geojson");
  }
  ~TempFile() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

BlockSet TwoByTwo(const geo::Geodetic& origin, double side_m) {
  BlockSet set;
  set.origin = origin;
  set.georeferenced = true;
  set.height_reference = geo::HeightReference::kEgm96;
  set.accuracy = {.scale_percent = 0.1 / 3.0, .tilt_deg = 0.3, .yaw_deg = 1.0 / 7.0, .horizontal_m = 1.5};
  set.rows = 2;
  set.columns = 2;
  set.image_width = 800;
  set.config_hash = "0123456789abcdef";
  for (int i = 0; i < 4; ++i) {
    Block block;
    block.id = i;
    block.name = "r" + std::to_string(i / 2) + "c" + std::to_string(i % 2);
    const int row = i / 2;
    block.min_enu = {side_m * (i % 2 - 1) + 0.1 / 3.0, side_m * (row - 1), -1.0 / 3.0};
    block.max_enu = block.min_enu + Eigen::Vector3d(side_m, side_m, 20.0 / 7.0);
    block.margin_m = 0.06 * side_m;
    block.altitude_agl_m = 100.0 / 3.0;
    block.gsd_m = 0.1 / 7.0;
    block.finest_voxel_m = 0.3 / 7.0;
    block.log2_table_size = 17;
    block.photos = {0, 3, 7 + i};
    block.expected_pixels = 1e6 / 3.0;
    block.cost = 0.25;
    set.blocks.push_back(block);
  }
  set.blocks[3].empty = true;
  set.blocks[3].empty_reason = "no training photo sees it";
  set.blocks[3].photos.clear();
  set.blocks[3].altitude_agl_m = std::nan("");
  return set;
}

void ExpectEqual(const BlockSet& a, const BlockSet& b) {
  EXPECT_EQ(a.origin.latitude_deg, b.origin.latitude_deg);
  EXPECT_EQ(a.origin.longitude_deg, b.origin.longitude_deg);
  EXPECT_EQ(a.origin.height_m, b.origin.height_m);
  EXPECT_EQ(a.georeferenced, b.georeferenced);
  EXPECT_EQ(a.height_reference, b.height_reference);
  EXPECT_EQ(survey::ToJson(a.accuracy), survey::ToJson(b.accuracy));
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.image_width, b.image_width);
  EXPECT_EQ(a.config_hash, b.config_hash);
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (size_t i = 0; i < a.blocks.size(); ++i) {
    const Block& x = a.blocks[i];
    const Block& y = b.blocks[i];
    EXPECT_EQ(x.id, y.id);
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.min_enu, y.min_enu);
    EXPECT_EQ(x.max_enu, y.max_enu);
    EXPECT_EQ(x.margin_m, y.margin_m);
    EXPECT_TRUE(x.altitude_agl_m == y.altitude_agl_m || (std::isnan(x.altitude_agl_m) && std::isnan(y.altitude_agl_m)));
    EXPECT_EQ(x.gsd_m, y.gsd_m);
    EXPECT_EQ(x.finest_voxel_m, y.finest_voxel_m);
    EXPECT_EQ(x.log2_table_size, y.log2_table_size);
    EXPECT_EQ(x.photos, y.photos);
    EXPECT_EQ(x.expected_pixels, y.expected_pixels);
    EXPECT_EQ(x.cost, y.cost);
    EXPECT_EQ(x.empty, y.empty);
    EXPECT_EQ(x.empty_reason, y.empty_reason);
  }
}

double RingArea(const Json& ring) {
  double twice = 0.0;
  for (size_t i = 0; i + 1 < ring.size(); ++i) {
    const double x0 = ring[i][0].get<double>() - ring[0][0].get<double>();
    const double y0 = ring[i][1].get<double>() - ring[0][1].get<double>();
    const double x1 = ring[i + 1][0].get<double>() - ring[0][0].get<double>();
    const double y1 = ring[i + 1][1].get<double>() - ring[0][1].get<double>();
    twice += x0 * y1 - x1 * y0;
  }
  return 0.5 * twice;
}

// Checks what RFC 7946 requires of every ring: closed, counter-clockwise, valid coordinates, no edge across the whole map.
void ExpectGoodRing(const Json& ring, bool polar) {
  ASSERT_GE(ring.size(), 4U);
  EXPECT_EQ(ring.front(), ring.back());
  EXPECT_GT(RingArea(ring), 0.0);
  for (size_t i = 0; i < ring.size(); ++i) {
    const double lon = ring[i][0].get<double>();
    const double lat = ring[i][1].get<double>();
    EXPECT_GE(lon, -180.0);
    EXPECT_LE(lon, 180.0);
    EXPECT_GE(lat, -90.0);
    EXPECT_LE(lat, 90.0);
    if (!polar && i > 0) {
      EXPECT_LT(std::abs(lon - ring[i - 1][0].get<double>()), 180.0);
    }
  }
}

// Saves the blocks, checks that loading gives the same blocks, and returns the file as JSON.
Json SavedAndLoaded(const BlockSet& set) {
  const TempFile file;
  SaveBlocks(set, file.path());
  ExpectEqual(set, LoadBlocks(file.path()));
  return Json::parse(base::ReadFile(file.path()));
}

class AnywhereOnEarth : public testing::TestWithParam<geo::Geodetic> {};

TEST_P(AnywhereOnEarth, RoundTripIsExactAndGeometryValid) {
  for (const double side_m : {1.0, 150.0, 100e3}) {
    const BlockSet set = TwoByTwo(GetParam(), side_m);
    const Json root = SavedAndLoaded(set);
    EXPECT_EQ(root["type"], "FeatureCollection");
    EXPECT_EQ(root["bbox"].size(), 4U);
    for (const Json& feature : root["features"]) {
      EXPECT_EQ(feature["type"], "Feature");
      const Json& bbox = feature["bbox"];
      const bool polar = bbox[3].get<double>() == 90.0 || bbox[1].get<double>() == -90.0;
      const Json& geometry = feature["geometry"];
      if (geometry["type"] == "Polygon") {
        ExpectGoodRing(geometry["coordinates"][0], polar);
      } else {
        ASSERT_EQ(geometry["type"], "MultiPolygon");
        EXPECT_GT(bbox[0].get<double>(), bbox[2].get<double>()) << "west is greater than east across the date line";
        for (const Json& polygon : geometry["coordinates"]) ExpectGoodRing(polygon[0], polar);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Places, AnywhereOnEarth,
                         testing::Values(geo::Geodetic{40.5, -73.9, 10}, geo::Geodetic{-33.8, 151.2, -20}, geo::Geodetic{0, 0, 0},
                                         geo::Geodetic{-17.0, 179.9999, 0}, geo::Geodetic{65.0, -180.0, 9000}, geo::Geodetic{90, 0, 0},
                                         geo::Geodetic{-90, 0, 2800}, geo::Geodetic{89.9995, 120, 0}, geo::Geodetic{-89.5, -179.9, 0}));

TEST(BlocksGeoJson, DateLineIsSplit) {
  const Json root = SavedAndLoaded(TwoByTwo({-17.0, 179.9999, 0}, 150.0));
  EXPECT_EQ(root["features"][0]["geometry"]["type"], "Polygon");
  const Json& east = root["features"][1];
  ASSERT_EQ(east["geometry"]["type"], "MultiPolygon");
  ASSERT_EQ(east["geometry"]["coordinates"].size(), 2U);
  const double area = RingArea(east["geometry"]["coordinates"][0][0]) + RingArea(east["geometry"]["coordinates"][1][0]);
  EXPECT_NEAR(area / RingArea(root["features"][0]["geometry"]["coordinates"][0]), 1.0, 1e-3) << "nothing is lost in the cut";
  EXPECT_GT(root["bbox"][0].get<double>(), 179.99);
  EXPECT_LT(root["bbox"][2].get<double>(), -179.99);
}

TEST(BlocksGeoJson, CornersAreWhereTheyShouldBe) {
  const TempFile file;
  SaveBlocks(TwoByTwo({0, 10, 0}, 1000.0), file.path());
  const Json ring = Json::parse(base::ReadFile(file.path()))["features"][0]["geometry"]["coordinates"][0];
  ASSERT_EQ(ring.size(), 5U);
  // One degree on the equator is 111319.49 m east and 110574.27 m north.
  EXPECT_NEAR(ring[0][0].get<double>(), 10.0 - 999.9667 / 111319.49, 1e-8);
  EXPECT_NEAR(ring[0][1].get<double>(), -1000.0 / 110574.27, 1e-8);
}

TEST(BlocksGeoJson, PoleIsCovered) {
  std::vector<Eigen::Vector2d> north = {{-135, 89}, {-45, 89}, {45, 89}, {135, 89}};
  const LonLatOutline cap = MakeOutline(north);
  ASSERT_EQ(cap.parts.size(), 1U);
  EXPECT_EQ(cap.north_deg, 90.0);
  EXPECT_EQ(cap.south_deg, 89.0);
  EXPECT_EQ(cap.west_deg, -180.0);
  EXPECT_EQ(cap.east_deg, 180.0);
  // Seen from above, longitudes run backwards around the south pole.
  std::vector<Eigen::Vector2d> south = {{135, -89}, {45, -89}, {-45, -89}, {-135, -89}};
  EXPECT_EQ(MakeOutline(south).south_deg, -90.0);
}

TEST(BlocksGeoJson, WithoutGeoReferenceMetresAreWritten) {
  BlockSet set = TwoByTwo({0, 0, 0}, 100.0);
  set.georeferenced = false;
  const Json root = SavedAndLoaded(set);
  EXPECT_EQ(root["skyquilt:georeferenced"], false);
  EXPECT_EQ(root["features"][0]["geometry"]["coordinates"][0][0][1].get<double>(), -100.0);
}

TEST(BlocksGeoJson, AccuracyIsNullWhereUnknown) {
  const Json root = SavedAndLoaded(TwoByTwo({1, 2, 3}, 100.0));
  EXPECT_EQ(root["skyquilt:accuracy"]["tilt_deg"], 0.3);
  EXPECT_EQ(root["skyquilt:accuracy"]["scale_percent"], 0.1 / 3.0);
  EXPECT_TRUE(root["skyquilt:accuracy"].at("vertical_m").is_null());
}

TEST(BlocksGeoJson, FilesOfOlderProgramsHaveUnknownAccuracy) {
  const TempFile file;
  SaveBlocks(TwoByTwo({1, 2, 3}, 100.0), file.path());
  Json older = Json::parse(base::ReadFile(file.path()));
  older.erase("skyquilt:accuracy");
  older.erase("skyquilt:height_reference");
  base::WriteFileAtomically(file.path(), base::JsonText(older));
  BlockSet expected = TwoByTwo({1, 2, 3}, 100.0);
  expected.accuracy = {};
  expected.height_reference = geo::HeightReference::kUnknown;
  ExpectEqual(LoadBlocks(file.path()), expected);
}

TEST(BlocksGeoJson, DamagedFilesAreRefusedByName) {
  const TempFile file;
  const auto expect_refused = [&](const std::string& text) {
    std::ofstream(file.path()) << text;
    try {
      LoadBlocks(file.path());
      ADD_FAILURE() << "accepted: " << text.substr(0, 60);
    } catch (const base::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(file.path().filename().string()), std::string::npos);
    }
  };
  expect_refused("");
  expect_refused("{");
  expect_refused("[1, 2]");
  expect_refused(R"({"type": "FeatureCollection", "features": []})");
  SaveBlocks(TwoByTwo({1, 2, 3}, 100.0), file.path());
  const Json good = Json::parse(base::ReadFile(file.path()));
  Json bad = good;
  bad["features"].erase(2);
  expect_refused(base::JsonText(bad));
  bad = good;
  bad["features"][1]["properties"]["max_enu"][0] = -1e6;
  expect_refused(base::JsonText(bad));
  bad = good;
  bad["features"][1]["properties"]["margin_m"] = "wide";
  expect_refused(base::JsonText(bad));
  bad = good;
  bad["features"][1]["properties"].erase("photos");
  expect_refused(base::JsonText(bad));
  bad = good;
  bad["skyquilt:origin"]["latitude_deg"] = 91.0;
  expect_refused(base::JsonText(bad));
  bad = good;
  bad["skyquilt:height_reference"] = "sea level";
  expect_refused(base::JsonText(bad));
  bad = good;
  bad["skyquilt:accuracy"]["tilt_deg"] = "small";
  expect_refused(base::JsonText(bad));
  EXPECT_THROW(LoadBlocks(file.path().string() + ".missing"), base::InputError);
}

}  // namespace
}  // namespace skyquilt::partition
