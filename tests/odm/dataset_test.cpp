#include "odm/dataset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/image.h"
#include "odm/after_poses.h"
#include "tests/support/error_of.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::odm {
namespace {

namespace fs = std::filesystem;

TEST(RestoreQuotes, GivesJsonItsQuotesBack) {
  const std::string json =
      R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:OGC:1.3:CRS84"}},)"
      R"("features":[{"type":"Feature","properties":{"a b":true,"n":null},"geometry":{"type":"Polygon","coordinates":[[[-81.5,41.3],[-81.4,41.3e0]]]}}]})";
  std::string bare;
  for (const char c : json) {
    if (c != '"') bare += c;
  }
  EXPECT_EQ(base::ParseJson(RestoreQuotes(bare)), base::ParseJson(json));
  EXPECT_EQ(RestoreQuotes(json), json) << "valid JSON stays as it is";
  EXPECT_EQ(RestoreQuotes("{ type : Point , coordinates : [ 1 , 2 ] }").find("\"type\""), 2U);
  EXPECT_EQ(RestoreQuotes("{a:[}"), "{a:[}") << "what cannot be understood is unchanged";
}

class OdmDataset : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "set" / "images");
    const image::Image8 picture(400, 300, 3);
    for (const char* name : {"a.jpg", "b.jpg"}) image::SaveJpeg(picture, folder_ / "set" / "images" / name, 90);
  }
  Dataset Find(std::vector<std::string> words = {}) {
    words.insert(words.end(), {"--project-path", folder_.path().string(), "set"});
    return FindDataset(Request::Parse(words), threads_);
  }
  TemporaryFolder folder_;
  base::ThreadPool threads_{1};
};

TEST_F(OdmDataset, HasPhotosAndTheFilesBesideThem) {
  const fs::path gcp = folder_ / "set" / "gcp_list.txt";
  base::WriteFileAtomically(gcp, "EPSG:4326\n");
  base::WriteFileAtomically(folder_ / "set" / "image_groups.txt", "a.jpg A\n");
  const Dataset dataset = Find();
  EXPECT_EQ(dataset.photos, 2);
  EXPECT_NEAR(dataset.megapixels, 0.12, 1e-12);
  EXPECT_EQ(dataset.gcp, gcp.string());
  EXPECT_EQ(dataset.geo, "");
  EXPECT_TRUE(dataset.has_groups);
  EXPECT_EQ(dataset.project, folder_ / "set" / "skyquilt");
  EXPECT_EQ(Find({"--use-exif"}).gcp, "") << "control points are not used then";
  base::WriteFileAtomically(folder_ / "other.txt", "EPSG:4326\n");
  EXPECT_EQ(Find({"--gcp", (folder_ / "other.txt").string()}).gcp, (folder_ / "other.txt").string());
}

TEST_F(OdmDataset, SaysWhatIsMissing) {
  EXPECT_NE(InputErrorOf([&] { Find({"--gcp", "/none.txt"}); }).find("--gcp"), std::string::npos);
  fs::remove_all(folder_ / "set" / "images");
  EXPECT_NE(InputErrorOf([&] { Find(); }).find("Put the photos there"), std::string::npos);
  fs::create_directories(folder_ / "set" / "images");
  EXPECT_NE(InputErrorOf([&] { Find(); }), "") << "no photos";
  fs::remove_all(folder_ / "set");
  EXPECT_NE(InputErrorOf([&] { Find(); }).find("--project-path"), std::string::npos);
}

TEST_F(OdmDataset, TheBoundaryIsAFileOrItsText) {
  const Dataset dataset = Find();
  fs::create_directories(dataset.project);
  const auto provide = [&](const std::string& value) {
    return ProvideBoundary(Request::Parse({"--project-path", folder_.path().string(), "--boundary", value, "set"}), dataset);
  };
  EXPECT_EQ(ProvideBoundary(Request::Parse({"--project-path", "/x", "set"}), dataset), "");
  const std::string text = R"({"type":"Polygon","coordinates":[[[1,2],[3,4],[5,6],[1,2]]]})";
  base::WriteFileAtomically(folder_ / "site.geojson", text);
  EXPECT_EQ(base::ReadFile(provide((folder_ / "site.geojson").string())), text);
  EXPECT_EQ(base::ParseJson(base::ReadFile(provide("{type:Polygon,coordinates:[[[1,2],[3,4],[5,6],[1,2]]]}"))), base::ParseJson(text));
  EXPECT_NE(InputErrorOf([&] { provide("site"); }).find("--boundary"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { provide("{type:Point,coordinates:[1,2]}"); }).find("no polygon"), std::string::npos);
}

survey::Survey FlightAt(double agl_m) {
  survey::Survey survey;
  survey.cameras = {{.model = camera::CameraModel::kPinhole, .width = 4000, .height = 3000, .params = {3000, 3000, 2000, 1500}}};
  for (const double x : {-50.0, 50.0}) {
    for (const double y : {-30.0, 30.0}) {
      survey.photos.push_back(NadirPhoto({x, y, agl_m}, "p" + std::to_string(survey.photos.size())));
      survey.photos.back().agl_m = agl_m;
    }
  }
  return survey;
}

TEST(AfterPoses, CellsAreNotFinerThanPixels) {
  const auto cells = [](std::vector<std::string> words, double agl_m) {
    words.insert(words.begin(), {"--project-path", "/x"});
    return CellsOf(Request::Parse(words), FlightAt(agl_m));
  };
  EXPECT_NEAR(PhotoGsd(FlightAt(60.0)), 0.02, 1e-12);
  EXPECT_NEAR(cells({}, 60.0).orthophoto_m, 0.05, 1e-12) << "OpenDroneMap's default";
  EXPECT_NEAR(cells({"--orthophoto-resolution", "1"}, 60.0).orthophoto_m, 0.02, 1e-12);
  EXPECT_NEAR(cells({"--orthophoto-resolution", "1", "--ignore-gsd"}, 60.0).orthophoto_m, 0.01, 1e-12);
  EXPECT_NEAR(cells({"--dem-resolution", "20"}, 60.0).heights_m, 0.2, 1e-12);
  EXPECT_NEAR(cells({}, 300.0).heights_m, 0.1, 1e-12);
  EXPECT_NEAR(cells({}, std::nan("")).heights_m, 0.05, 1e-12) << "an unknown height limits nothing";
}

TEST(AfterPoses, ABoundaryElsewhereIsRefused) {
  const TemporaryFolder folder;
  survey::Survey survey = FlightAt(60.0);
  const auto error_with = [&](const std::string& ring) {
    const fs::path file = folder / "area.geojson";
    base::WriteFileAtomically(file, R"({"type":"Polygon","coordinates":[[)" + ring + "]]}");
    return InputErrorOf([&] { RequireBoundaryMeets(survey, file); });
  };
  EXPECT_EQ(error_with("[40,20],[90,20],[90,90],[40,20]"), "") << "a corner of the flight";
  EXPECT_NE(error_with("[60,0],[90,0],[90,90],[60,0]").find("lies 10 m beside the photos"), std::string::npos) << "the cameras end at 50";
  survey.points.push_back({.x_in_enu = {70.0, 10.0, 0.0}});
  EXPECT_EQ(error_with("[60,0],[90,0],[90,90],[60,0]"), "") << "what the photos show";
  survey.georeferenced = true;
  survey.origin = {47.0, 8.0, 400.0};
  EXPECT_EQ(error_with("[7.999,46.999],[8.001,46.999],[8.001,47.001],[7.999,46.999]"), "");
  EXPECT_NE(error_with("[46.999,7.999],[46.999,8.001],[47.001,8.001],[46.999,7.999]"), "") << "latitude before longitude";
}

TEST(AfterPoses, TheAutomaticBoundaryHoldsTheCameras) {
  const TemporaryFolder folder;
  WriteAutoBoundary(FlightAt(60.0), 0.0, folder / "hull.geojson");
  const nlohmann::json json = base::ParseJson(base::ReadFile(folder / "hull.geojson"));
  const nlohmann::json& ring = json.at("features").at(0).at("geometry").at("coordinates").at(0);
  EXPECT_EQ(ring.front(), ring.back());
  double west = 0.0, east = 0.0, north = 0.0, area = 0.0;
  for (size_t i = 0; i + 1 < ring.size(); ++i) {
    const double x = ring[i][0].get<double>(), y = ring[i][1].get<double>();
    west = std::min(west, x);
    east = std::max(east, x);
    north = std::max(north, y);
    area += 0.5 * (x * ring[i + 1][1].get<double>() - ring[i + 1][0].get<double>() * y);
  }
  EXPECT_NEAR(west, -80.0, 1e-9) << "widened by half of the flying height";
  EXPECT_NEAR(east, 80.0, 1e-9);
  EXPECT_NEAR(north, 60.0, 1e-9);
  const double circle = std::acos(-1.0) * 900.0;
  EXPECT_NEAR(area, 100.0 * 60.0 + 2.0 * 30.0 * (100.0 + 60.0) + circle, 0.01 * circle) << "counter-clockwise, with round corners";
  survey::Survey unknown = FlightAt(std::nan(""));
  EXPECT_NE(InputErrorOf([&] { WriteAutoBoundary(unknown, 0.0, folder / "none.geojson"); }).find("--auto-boundary-distance"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::odm
