#include "viewer/data/gcp_list.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/geo/crs.h"
#include "core/geo/utm.h"
#include "tests/support/error_of.h"
#include "tests/support/nadir_photo.h"

namespace skyquilt::viewer {
namespace {

const geo::UtmZone kZone = {32, true};

survey::Survey SurveyOf(const std::vector<std::string>& names) {
  survey::Survey survey;
  survey.cameras.push_back({camera::CameraModel::kSimplePinhole, 4000, 3000, {3000.0, 2000.0, 1500.0}});
  for (const std::string& name : names) survey.photos.push_back(NadirPhoto({0.0, 0.0, 50.0}, name));
  survey.unregistered.push_back("blurred.jpg");
  return survey;
}

nlohmann::json Read(const std::string& text, const std::optional<geo::UtmZone>& zone, const MarkablePhotos& photos) {
  return ReadGcpList("gcp_list.txt", text, zone, photos);
}

TEST(GcpList, ReadsWhatOthersWrite) {
  const survey::Survey survey = SurveyOf({"a.jpg", "west/b.jpg", "west/c.jpg", "east/c.jpg"});
  const nlohmann::json gcp = Read(
      "\xEF\xBB\xBF# comment\r\n"
      "WGS84 UTM 32N\r\n"
      "465400.5\t5247100.25 410 100.5 200.25 A.JPG north\r\n"
      "\n"
      "465400.5 5247100.25 410 1 2 b.jpg north extra words\n"
      "465400.5 5247100.25 410 7 8 b.jpg north\n"
      "1 2 3 4 5 c.jpg\n"
      "1 2 3 6 7 blurred.jpg\n"
      "1 2 3 4\n"
      "1 2 three 4 5 a.jpg\n"
      "1 2 3 4001 5 a.jpg\n"
      "1 2 nan 4 5 a.jpg",
      kZone, MarkablePhotos(&survey));
  EXPECT_EQ(gcp["crs"], "EPSG:32632");
  ASSERT_EQ(gcp["points"].size(), 2U);
  EXPECT_EQ(gcp["points"][0]["name"], "north");
  ASSERT_EQ(gcp["points"][0]["marks"].size(), 2U);
  EXPECT_EQ(gcp["points"][0]["marks"][0], base::ParseJson(R"({"photo": "a.jpg", "pixel": [101.0, 200.75]})"));
  EXPECT_EQ(gcp["points"][0]["marks"][1], base::ParseJson(R"({"photo": "west/b.jpg", "pixel": [7.5, 8.5]})")) << "the last mark in a photo counts";
  EXPECT_EQ(gcp["points"][1]["name"], "");
  ASSERT_EQ(gcp["points"][1]["marks"].size(), 2U) << "the same place without a name is one point";
  EXPECT_EQ(gcp["points"][1]["marks"][0]["unknown"], true) << "two photos have this name";
  EXPECT_FALSE(gcp["points"][1]["marks"][1].contains("unknown")) << "a photo without pose can be marked";
  EXPECT_EQ(gcp["skipped"], 4);
  EXPECT_EQ(gcp["remarks"], base::ParseJson(R"(["line 9: has 4 fields instead of 6 or more", "line 10: 'three' is not a number",
    "line 11: the mark of point 1 is outside a.jpg", "line 12: point 2 has no height"])"));
}

TEST(GcpList, LeavesOutPointsThatCannotBeThere) {
  const survey::Survey survey = SurveyOf({"a.jpg", "b.jpg", "my photo.jpg"});
  const nlohmann::json gcp = Read(
      "EPSG:4326\n8.5 91 0 1 2 a.jpg pole\n8.5 91 0 1 2 b.jpg pole\n8.5 47.4 0 1 2 a.jpg p\n8.6 47.4 0 1 2 b.jpg p\n"
      "8.5 47.4 0 1 2 my photo.jpg p\n",
      kZone, MarkablePhotos(&survey));
  ASSERT_EQ(gcp["points"].size(), 1U);
  ASSERT_EQ(gcp["points"][0]["marks"].size(), 2U);
  EXPECT_EQ(gcp["points"][0]["marks"][1]["photo"], "my photo.jpg");
  EXPECT_EQ(gcp["skipped"], 3);
  ASSERT_EQ(gcp["remarks"].size(), 4U);
  EXPECT_EQ(gcp["remarks"][0], "heights are taken as metres above the ellipsoid, as the system says nothing about them");
  EXPECT_EQ(gcp["remarks"][2], "line 3: pole: the position is outside this coordinate system");
  EXPECT_EQ(gcp["remarks"][3], "line 5: gives p other coordinates than line 4");
}

TEST(GcpList, KnowsTheUsualCoordinateSystems) {
  const survey::Survey survey = SurveyOf({"a.jpg"});
  const MarkablePhotos photos(&survey);
  const geo::Geodetic place{47.3769, 8.5417, 410.0};
  const Eigen::Vector2d own = geo::UtmFromGeodetic(place, kZone), neighbour = geo::UtmFromGeodetic(place, {31, true});
  const auto line = [](double x, double y) { return "\n" + std::to_string(x) + " " + std::to_string(y) + " 410 1 2 a.jpg p\n"; };
  const auto x_of = [&](const std::string& text) {
    const nlohmann::json gcp = Read(text, kZone, photos);
    return gcp["points"].empty() ? 0.0 : gcp["points"][0]["x"].get<double>();
  };
  for (const char* header :
       {"EPSG:32632", "epsg: 32632", "WGS84 UTM 32N", "WGS84 UTM 32 N", "+proj=utm +zone=32 +datum=WGS84 +units=m +no_defs", "EPSG:25832"}) {
    EXPECT_NEAR(x_of(header + line(own.x(), own.y())), own.x(), 1e-3) << header;
  }
  for (const char* header : {"EPSG:32631", "+proj=utm +zone=31 +ellps=WGS84"}) {
    EXPECT_NEAR(x_of(header + line(neighbour.x(), neighbour.y())), own.x(), 1e-3) << header;
  }
  for (const char* header : {"EPSG:4326", "+proj=longlat +datum=WGS84", "WGS84"}) {
    EXPECT_NEAR(x_of(header + line(place.longitude_deg, place.latitude_deg)), own.x(), 0.1) << header;
  }
  const Eigen::Vector3d swiss = geo::Crs("EPSG:2056").FromGeodetic({place.latitude_deg, place.longitude_deg, 0.0});
  EXPECT_NEAR(x_of("EPSG:2056" + line(swiss.x(), swiss.y())), own.x(), 1e-3);
  const std::string row = "\n1 2 3 4 5 a.jpg p\n";
  for (const char* header : {"EPSG:1", "WGS84 UTM 61N", "465400 5247100 410 1 2 a.jpg", "LOCAL"}) {
    EXPECT_NE(InputErrorOf([&] { Read(header + row, kZone, photos); }), "") << header;
  }
  EXPECT_EQ(Read("LOCAL" + row, {}, photos)["points"][0]["x"], 1.0);
  EXPECT_NE(InputErrorOf([&] { Read("EPSG:32632" + row, {}, photos); }).find("no geo-reference"), std::string::npos);
}

TEST(GcpList, ReadsBackWhatItWrites) {
  const survey::Survey survey = SurveyOf({"west/1.jpg", "east/1.jpg", "west/2.jpg"});
  const MarkablePhotos photos(&survey);
  const nlohmann::json gcp = base::ParseJson(R"({"crs": "EPSG:32632", "points": [
    {"name": "a", "x": 465400.1234, "y": 5247100.25, "z": -410.5,
     "marks": [{"photo": "west/1.jpg", "pixel": [0.25, 2999.75]}, {"photo": "west/2.jpg", "pixel": [1.0, 2.0]}]},
    {"name": "b", "x": 1.0, "y": 2.0, "z": 3.0, "marks": [{"photo": "east/1.jpg", "pixel": [5.0, 6.0]}]}]})");
  const std::string text = GcpListText(gcp, photos);
  EXPECT_NE(text.find(" 2.jpg a\n"), std::string::npos) << "without the folder, as OpenDroneMap wants it";
  EXPECT_NE(text.find(" west/1.jpg a\n"), std::string::npos) << "but not when another photo has this name";
  EXPECT_EQ(Read(text, kZone, photos), gcp);
}

TEST(GcpList, BlanksInNamesDoNotMoveFields) {
  const survey::Survey survey = SurveyOf({"my photo.jpg", "b.jpg"});
  const MarkablePhotos photos(&survey);
  const nlohmann::json gcp = base::ParseJson(R"({"crs": null, "points": [
    {"name": "p 1", "x": 1, "y": 2, "z": 3, "marks": [{"photo": "my photo.jpg", "pixel": [4, 5]}, {"photo": "b.jpg", "pixel": [6, 7]}]},
    {"name": "p_1", "x": 1, "y": 2, "z": 3, "marks": [{"photo": "b.jpg", "pixel": [8, 9]}]}]})");
  EXPECT_EQ(GcpListText(gcp, photos),
            "LOCAL\n# a photo with blanks in its name: 1.0000 2.0000 3.0000 3.50 4.50 my photo.jpg p_1\n"
            "1.0000 2.0000 3.0000 5.50 6.50 b.jpg p_1\n1.0000 2.0000 3.0000 7.50 8.50 b.jpg p_1_2\n");
}

TEST(GcpList, EmptyAndOddTextsAreNoPoints) {
  const MarkablePhotos none(nullptr);
  for (const char* text : {"EPSG:32632", "EPSG:32632\n\n#x\n", "EPSG:32632\n1e400 2 3 4 5 a.jpg", "EPSG:4326\n8 91 0 1 2 a.jpg"}) {
    EXPECT_TRUE(Read(text, kZone, none)["points"].empty()) << text;
  }
  for (const std::string& text :
       {std::string(), std::string("\n\n"), std::string("#"), std::string("\xff\xfe"), std::string("EPSG:"), std::string("WGS84 UTM"),
        std::string("WGS84 UTM N"), std::string("+proj="), std::string("EPSG:99999999999"), std::string(5U << 20U, 'x')}) {
    EXPECT_NE(InputErrorOf([&] { Read(text, kZone, none); }), "") << text.substr(0, 40);
  }
}

}  // namespace
}  // namespace skyquilt::viewer
