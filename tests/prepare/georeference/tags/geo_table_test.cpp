#include "prepare/georeference/tags/geo_table.h"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <fstream>

#include "core/geo/utm.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::georeference {
namespace {

input::PhotoFile GeoPhoto(const std::string& name, std::optional<geo::Geodetic> gps = {}) {
  input::PhotoFile photo{.name = name, .width = 4, .height = 3, .tags = {}};
  photo.tags.gps = gps;
  return photo;
}

class GeoTables : public ::testing::Test {
 protected:
  GeoTable Read(const std::string& text) {
    std::ofstream(folder_ / "geo.txt", std::ios::binary) << text;
    return ReadGeoTable(folder_ / "geo.txt", photos_);
  }
  std::string ErrorOfTable(const std::string& text) {
    return InputErrorOf([&] { Read(text); });
  }
  // Of a table with one row that names the first photo.
  void ExpectFirst(const std::string& text, double height_m = 400.5) {
    const GeoTable table = Read(text);
    ASSERT_EQ(table.rows.size(), 1U) << text;
    EXPECT_EQ(table.rows[0].index, 0U) << text;
    EXPECT_NEAR(table.rows[0].position.longitude_deg, 8.4, 1e-9) << text;
    EXPECT_NEAR(table.rows[0].position.latitude_deg, 47.1, 1e-9) << text;
    EXPECT_EQ(std::isnan(table.rows[0].position.height_m), std::isnan(height_m)) << text;
    if (!std::isnan(height_m)) {
      EXPECT_NEAR(table.rows[0].position.height_m, height_m, 1e-9) << text;
    }
  }

  TemporaryFolder folder_;
  std::vector<input::PhotoFile> photos_ = {GeoPhoto("sub/DJI 0001.JPG"), GeoPhoto("b.jpg"), GeoPhoto("c.jpg")};
};

TEST_F(GeoTables, NamesMayBeWrittenInManyWays) {
  for (const char* name : {"DJI 0001.JPG", "dji 0001.jpg", "DJI 0001", "sub/DJI 0001.JPG", "C:\\Users\\me\\DJI 0001.JPG", "\"DJI 0001.JPG\"",
                           "/home/me/other folder/DJI 0001.JPG"}) {
    ExpectFirst(std::string("EPSG:4326\n") + name + " 8.4 47.1 400.5\n");
    ExpectFirst(std::string("EPSG:4326\n") + name + "\t8.4\t47.1\t400.5\n");
    ExpectFirst(std::string("EPSG:4326\n") + name + ",8.4,47.1,400.5\n");
    ExpectFirst(std::string("EPSG:4326\n") + name + ";8,4;47,1;400,5\n");
  }
}

TEST_F(GeoTables, HeightsMayBeMissing) {
  const double none = std::nan("");
  for (const char* row : {"DJI 0001.JPG 8.4 47.1 NaN", "DJI 0001.JPG 8.4 47.1", "DJI 0001.JPG,8.4,47.1,", "DJI 0001.JPG,8.4,47.1,None,0,0,0,0.1,0.2"})
    ExpectFirst(std::string("EPSG:4326\n") + row + "\n", none);
}

TEST_F(GeoTables, HeadingsNameTheColumns) {
  ExpectFirst("EPSG:4326\nPhoto,Lat,Lon,Height\nDJI 0001.JPG,47.1,8.4,400.5\n");
  ExpectFirst("EPSG:4326\n#Label,X/Longitude,Y/Latitude,Z/Altitude\nDJI 0001,8.4,47.1,400.5\n");
  ExpectFirst("EPSG:4326\nBild;Ost;Nord;Hoehe\nDJI 0001.JPG;8,4;47,1;400,5\n");
  ExpectFirst("EPSG:4326\nfile lat lon alt\nDJI 0001.JPG 47.1 8.4 400.5\n");
  const GeoTable table = Read("SourceFile,GPSLatitude,GPSLongitude,GPSAltitude\n./DJI 0001.JPG,47.1,8.4,400.5\n");
  EXPECT_NEAR(table.rows[0].position.latitude_deg, 47.1, 1e-9);
  ASSERT_EQ(table.warnings.size(), 1U);
  EXPECT_NE(table.warnings[0].find("taken as WGS84 (EPSG:4326)"), std::string::npos) << table.warnings[0];
  const std::string error = ErrorOfTable("Photo,X,Y\nb.jpg,450000,5200000\n");
  EXPECT_NE(error.find("line 1: 'Photo,X,Y' is not a coordinate system"), std::string::npos) << error;
}

TEST_F(GeoTables, AccuraciesComeWithOrWithoutAngles) {
  for (const char* row : {"b.jpg 8.4 47.1 400 1 2 3 0.02 0.05 note", "b.jpg,8.4,47.1,400,0.02,0.05", "b.jpg,8.4,47.1,400,,,,0.02,0.05",
                          "b.jpg\t8.4\t47.1\t400\tNaN\tNaN\tNaN\t0.02\t0.05"}) {
    const GeoTable table = Read(std::string("EPSG:4326\n") + row + "\n");
    EXPECT_EQ(table.rows[0].horizontal_accuracy_m, 0.02) << row;
    EXPECT_EQ(table.rows[0].vertical_accuracy_m, 0.05) << row;
  }
  for (const char* row : {"b.jpg 8.4 47.1 400 1 2 3 0 NaN", "b.jpg 8.4 47.1 400 1 2 3", "b.jpg 8.4 47.1 400 17 label"}) {
    EXPECT_FALSE(Read(std::string("EPSG:4326\n") + row + "\n").rows[0].horizontal_accuracy_m) << row;
  }
}

TEST_F(GeoTables, RowsWithoutAFixCountForNothing) {
  const GeoTable table = Read("EPSG:4326\nb.jpg 8.4 47.1 400\nc.jpg 0 0 0\nDJI 0001.JPG NaN NaN NaN\n");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_NE(table.warnings.at(0).find("2 of 3 rows have no position"), std::string::npos) << table.warnings[0];
}

TEST_F(GeoTables, ExchangedAxesAreTakenTheOtherWayRoundWhereTagsProveIt) {
  for (input::PhotoFile& photo : photos_) photo.tags.gps = geo::Geodetic{47.1001, 8.4001, 400.0};
  const GeoTable table = Read("EPSG:4326\nb.jpg 47.1 8.4 400\nc.jpg 47.1 8.4001 400\n");
  EXPECT_TRUE(table.exchanged);
  EXPECT_NEAR(table.rows[0].position.latitude_deg, 47.1, 1e-9);
  EXPECT_NE(table.warnings.at(0).find("geo.txt: x and y look exchanged"), std::string::npos) << table.warnings[0];
  // A heading says more than the tags: they may be wrong.
  const GeoTable named = Read("EPSG:4326\nphoto lon lat height\nb.jpg 47.1 8.4 400\n");
  EXPECT_FALSE(named.exchanged);
  EXPECT_NE(named.warnings.at(0).find("look exchanged"), std::string::npos) << named.warnings[0];
  const Eigen::Vector2d utm = geo::UtmFromGeodetic({47.1, 8.4, 0.0}, {32, true});
  const GeoTable metres = Read(fmt::format("EPSG:32632\nb.jpg {:.3f} {:.3f} 400\n", utm.y(), utm.x()));
  EXPECT_TRUE(metres.exchanged);
  EXPECT_NEAR(metres.rows[0].position.longitude_deg, 8.4, 1e-7);
}

TEST_F(GeoTables, ExchangedAxesAreRecognisedByLatitudesBeyondThePole) {
  const GeoTable table = Read("EPSG:4326\nb.jpg 35.6 139.7 40\nc.jpg 35.6 139.71 40\n");
  EXPECT_TRUE(table.exchanged);
  EXPECT_NEAR(table.rows[1].position.longitude_deg, 139.71, 1e-9);
  // One slip among others proves nothing.
  const std::string slip = ErrorOfTable("EPSG:4326\nb.jpg 8.4 147.1 40\nc.jpg 8.4 47.1 40\n");
  EXPECT_NE(slip.find("line 2: the position is outside this coordinate system. Check that x is east"), std::string::npos) << slip;
}

TEST_F(GeoTables, GoodAxesStay) {
  // Near the line where longitude and latitude are equal both ways are near the tags.
  for (input::PhotoFile& photo : photos_) photo.tags.gps = geo::Geodetic{45.001, 45.0, 400.0};
  EXPECT_FALSE(Read("EPSG:4326\nb.jpg 45.001 45.0 400\n").exchanged);
  // Tags that are far away in both ways.
  for (input::PhotoFile& photo : photos_) photo.tags.gps = geo::Geodetic{-33.8, 151.2, 40.0};
  EXPECT_FALSE(Read("EPSG:4326\nb.jpg 8.4 47.1 400\n").exchanged);
}

TEST_F(GeoTables, FoldersTellPhotosOfOneNameApart) {
  photos_ = {GeoPhoto("100/DJI_1.JPG"), GeoPhoto("101/DJI_1.JPG"), GeoPhoto("102/DJI_2.JPG")};
  const GeoTable table = Read(
      "EPSG:4326\nD:\\flight\\101\\DJI_1.JPG 8.4 47.1 1\nD:\\flight\\100\\DJI_1.JPG 8.5 47.1 1\nDJI_1.JPG 8.6 47.1 1\n"
      "D:\\flight\\99\\DJI_2.JPG 8.7 47.1 1\nD:\\flight\\102\\DJI_2.JPG 8.8 47.1 1\n");
  ASSERT_EQ(table.rows.size(), 5U);
  EXPECT_EQ(table.rows[0].index, 1U);
  EXPECT_EQ(table.rows[1].index, 0U);
  EXPECT_EQ(table.rows[2].index, std::nullopt);
  EXPECT_EQ(table.rows[3].index, std::nullopt);
  EXPECT_EQ(table.rows[4].index, 2U);
  EXPECT_NE(table.warnings.at(0).find("line 4: 2 of 5 rows name no photo, or more than one: DJI_1.JPG"), std::string::npos) << table.warnings[0];
}

TEST_F(GeoTables, OnePhotoTwiceIsRefusedHoweverItIsWritten) {
  const std::string error = ErrorOfTable("EPSG:4326\nb.jpg 8.4 47.1\nB.JPG 8.4 47.2\n");
  EXPECT_NE(error.find("line 3: names B.JPG a second time, after line 2"), std::string::npos) << error;
}

// Tables of three photos in every dialect.
RC_GTEST_PROP(GeoTableProperty, PositionsReadBackTheSameInEveryDialect, ()) {
  const char separator = *rc::gen::element(',', ';', '\t', ' ');
  const bool decimal_comma = separator != ',' && *rc::gen::arbitrary<bool>();
  const bool heading = *rc::gen::arbitrary<bool>(), latitude_first = heading && *rc::gen::arbitrary<bool>();
  const bool windows = *rc::gen::arbitrary<bool>(), extension = *rc::gen::arbitrary<bool>(), height = *rc::gen::arbitrary<bool>();
  const std::string end = windows ? "\r\n" : "\n", between(1, separator), folder = *rc::gen::element("", "D:\\my photos\\", "survey/");
  std::vector<input::PhotoFile> photos;
  std::vector<geo::Geodetic> places;
  const auto number = [&](double value) {
    std::string text = fmt::format("{:.9f}", value);
    if (decimal_comma) text[text.find('.')] = ',';
    return text;
  };
  std::string text = (windows ? "\xEF\xBB\xBF" : "") + std::string("EPSG:4326") + end;
  if (heading) text += "photo" + between + (latitude_first ? "lat" + between + "lon" : "lon" + between + "lat") + between + "height" + end;
  for (int i = 0; i < 3; ++i) {
    const int east = *rc::gen::inRange(-179999999, 179999999), north = *rc::gen::inRange(-89999999, 89999999),
              up = *rc::gen::inRange(-400000, 9000000);
    if (east == 0 && north == 0) return;
    places.push_back({1e-6 * north, 1e-6 * east, height ? 1e-3 * up : std::nan("")});
    const std::string name = "IMG " + std::to_string(i) + " (a)";
    photos.push_back(GeoPhoto("sub/" + name + ".JPG"));
    const std::string x = number(1e-6 * east), y = number(1e-6 * north);
    text += folder + name + (extension ? ".jpg" : "") + between + (latitude_first ? y + between + x : x + between + y);
    text += (height ? between + number(1e-3 * up) : "") + end;
  }
  const TemporaryFolder temporary;
  std::ofstream(temporary / "geo.txt", std::ios::binary) << text;
  const GeoTable table = ReadGeoTable(temporary / "geo.txt", photos);
  RC_ASSERT(table.rows.size() == size_t{3});
  RC_ASSERT(!table.exchanged);
  for (size_t i = 0; i < 3; ++i) {
    RC_ASSERT(table.rows[i].index == std::optional(i));
    RC_ASSERT(std::abs(table.rows[i].position.latitude_deg - places[i].latitude_deg) < 1e-8);
    RC_ASSERT(std::abs(geo::WrapLongitudeDeg(table.rows[i].position.longitude_deg - places[i].longitude_deg)) < 1e-8);
    const bool same_height =
        height ? std::abs(table.rows[i].position.height_m - places[i].height_m) < 1e-6 : std::isnan(table.rows[i].position.height_m);
    RC_ASSERT(same_height);
  }
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
