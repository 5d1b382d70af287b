#include "prepare/georeference/tags/photo_positions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/geo/utm.h"
#include "prepare/georeference/tags/geo_table.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::georeference {
namespace {

constexpr const char* kMrkLine =
    "\t434205.122132\t[2036]\t   -10,N\t    18,E\t   193,V\t47.10000000,Lat\t8.40000000,Lon\t420.100,Ellh\t0.0118, 0.0137, 0.0249\t50,Q\n";

class PhotoPositions : public ::testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  static input::PhotoFile Photo(const std::string& name) {
    input::PhotoFile photo{.name = name, .width = 4, .height = 3, .tags = {}};
    photo.tags.gps = geo::Geodetic{47.1001, 8.4001, 400.0};
    photo.tags.dop = 2.0;
    return photo;
  }
  std::string GeoError(const std::string& text) {
    Write("table.txt", text);
    return InputErrorOf([&] { ReadGeoTable(folder_ / "table.txt", {Photo("a.jpg")}); });
  }

  TemporaryFolder folder_;
};

TEST_F(PhotoPositions, GeoFileReplacesTagsInAnyCoordinateSystem) {
  const Eigen::Vector2d utm = geo::UtmFromGeodetic({47.1, 8.4, 0.0}, {32, true});
  Write("geo.txt", "WGS84 UTM 32N\r\nA.JPG " + std::to_string(utm.x()) + " " + std::to_string(utm.y()) + " 431.5 0 0 0 0.02 0.05 any label\r\n" +
                       "b.jpg " + std::to_string(utm.x()) + " " + std::to_string(utm.y()) + "\r\nmissing.jpg 450000 5200000 1\r\n");
  std::vector<input::PhotoFile> photos = {Photo("sub/a.jpg"), Photo("b.jpg"), Photo("c.jpg")};
  UsePositionFiles(folder_.path(), "", photos);
  EXPECT_NEAR(photos[0].tags.gps->latitude_deg, 47.1, 1e-8);
  EXPECT_NEAR(photos[0].tags.gps->longitude_deg, 8.4, 1e-8);
  EXPECT_NEAR(photos[0].tags.gps->height_m, 431.5, 1e-6);
  EXPECT_EQ(photos[0].tags.horizontal_accuracy_m, 0.02);
  EXPECT_EQ(photos[0].tags.vertical_accuracy_m, 0.05);
  EXPECT_TRUE(photos[0].tags.rtk);
  EXPECT_EQ(photos[0].tags.position_file, (folder_ / "geo.txt").string());
  EXPECT_EQ(photos[2].tags.position_file, "");
  EXPECT_TRUE(std::isnan(photos[1].tags.gps->height_m));
  EXPECT_FALSE(photos[1].tags.rtk || photos[1].tags.horizontal_accuracy_m || photos[1].tags.dop);
  EXPECT_EQ(photos[2].tags.gps->latitude_deg, 47.1001);
}

TEST_F(PhotoPositions, GeoFilesOfZonesServeTheirPhotos) {
  std::filesystem::create_directories(folder_ / "photos");
  Write("monday/geo.txt", "EPSG:4326\na.jpg 8.41 47.11 401\n");
  Write("tuesday/geo.txt", "EPSG:4326\na.jpg 8.42 47.12 402\n");
  for (const char* zone : {"monday", "tuesday"}) std::filesystem::create_directory_symlink(folder_ / zone, folder_ / "photos" / zone);
  std::vector<input::PhotoFile> photos = {Photo("monday/a.jpg"), Photo("tuesday/a.jpg"), Photo("wednesday/a.jpg")};
  UsePositionFiles(folder_ / "photos", "", photos);
  EXPECT_NEAR(photos[0].tags.gps->latitude_deg, 47.11, 1e-8);
  EXPECT_NEAR(photos[1].tags.gps->latitude_deg, 47.12, 1e-8);
  EXPECT_NEAR(photos[2].tags.gps->latitude_deg, 47.1001, 1e-8);
  EXPECT_EQ(PositionFiles(folder_ / "photos", "").size(), 2U);
}

TEST_F(PhotoPositions, FaultsOfAGeoFileNameTheLine) {
  EXPECT_NE(GeoError("a.jpg 8 47 1\n").find("line 1: 'a.jpg 8 47 1' is not a coordinate system"), std::string::npos);
  EXPECT_NE(GeoError("EPSG:4326\na.jpg 8\n").find("line 2: has no x and y"), std::string::npos);
  EXPECT_NE(GeoError("EPSG:4326\n\na.jpg 8 x 1\n").find("line 3: 'x' is not a number"), std::string::npos);
  EXPECT_NE(GeoError("EPSG:4326\na.jpg 8 147 1\nb.jpg 8 47 1\n").find("line 2: the position is outside"), std::string::npos);
  EXPECT_NE(GeoError("EPSG:4326\na.jpg 8 47\na.jpg 8 47\n").find("line 3: names a.jpg a second time"), std::string::npos);
  EXPECT_NE(GeoError("EPSG:4326\n").find("has no positions"), std::string::npos);
  Write("geo.txt", "EPSG:4326\nother.jpg 8.4 47.1 1\n");
  std::vector<input::PhotoFile> photos = {Photo("a.jpg")};
  const std::string message = InputErrorOf([&] { UsePositionFiles(folder_.path(), "", photos); });
  EXPECT_NE(message.find("names none of the photos"), std::string::npos) << message;
}

TEST_F(PhotoPositions, MrkServesThePhotosOfItsFolderByNumber) {
  Write("flight/100_Timestamp.MRK", "7" + std::string(kMrkLine) + "8" + kMrkLine);
  std::vector<input::PhotoFile> photos = {Photo("flight/DJI_0007.JPG"), Photo("flight/DJI_20230101120000_0008_V.JPG"), Photo("flight/DJI_0009.JPG"),
                                          Photo("DJI_0007.JPG")};
  UsePositionFiles(folder_.path(), "", photos);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(photos[i].tags.gps->latitude_deg, 47.1);
    EXPECT_EQ(photos[i].tags.gps->longitude_deg, 8.4);
    EXPECT_EQ(photos[i].tags.gps->height_m, 420.1);
    EXPECT_EQ(photos[i].tags.horizontal_accuracy_m, 0.0137);
    EXPECT_EQ(photos[i].tags.vertical_accuracy_m, 0.0249);
    EXPECT_TRUE(photos[i].tags.rtk);
  }
  for (size_t i = 2; i < 4; ++i) EXPECT_EQ(photos[i].tags.gps->latitude_deg, 47.1001);
}

TEST_F(PhotoPositions, MrkOfAnotherFlightOrWithRepeatedNumbersIsNotUsed) {
  Write("one/a.MRK", "7" + std::string(kMrkLine));
  Write("one/b.MRK", "7" + std::string(kMrkLine));
  Write("two/a.MRK", "7" + std::string(kMrkLine));
  Write("three/a.MRK", "not a log\n");
  std::vector<input::PhotoFile> photos = {Photo("one/DJI_0007.JPG"), Photo("two/DJI_0007.JPG"), Photo("three/DJI_0007.JPG")};
  photos[1].tags.gps->latitude_deg = 47.3;
  const double before[] = {47.1001, 47.3, 47.1001};
  UsePositionFiles(folder_.path(), "", photos);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(photos[i].tags.gps->latitude_deg, before[i]);
}

TEST_F(PhotoPositions, FaultsOfAnMrkNameTheLine) {
  Write("a.MRK", "7" + std::string(kMrkLine) + "8 1.0 [2036] 5,Lat\n");
  const std::string message = InputErrorOf([&] { ReadMrkFile(folder_ / "a.MRK"); });
  EXPECT_NE(message.find("line 2: has no number before Lon"), std::string::npos) << message;
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
