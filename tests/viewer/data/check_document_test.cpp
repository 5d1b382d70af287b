// What browsers may not save, and what must not prevent saving.
#include <gtest/gtest.h>

#include "core/base/json_text.h"
#include "products/camera_path.h"
#include "tests/viewer/data/sample_project.h"

namespace skyquilt::viewer {
namespace {

nlohmann::json OnePoint() {
  return base::ParseJson(R"({"crs": "EPSG:32632", "points": [
    {"name": "GCP 1", "x": 465400.5, "y": 5247100.25, "z": 410, "marks": [{"photo": "IMG_0.jpg", "pixel": [100.5, 200.25]}]}]})");
}

TEST(CheckDocument, ControlPointsFitTheProject) {
  SampleProject sample;
  ProjectData data(sample.project);
  const auto refused = [&](const std::function<void(nlohmann::json&)>& spoil) {
    nlohmann::json json = OnePoint();
    spoil(json);
    return data.Put("gcp.json", base::JsonText(json), "").status == 400;
  };
  // The front end would not read these again.
  EXPECT_TRUE(refused([](auto& json) { json["crs"] = nullptr; }));
  EXPECT_TRUE(refused([](auto& json) { json["crs"] = "EPSG:32633"; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["name"] = "a\nb"; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["marks"][0]["photo"] = "other.jpg"; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["marks"][0]["pixel"] = {640.5, 1}; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["marks"][0]["pixel"] = {-0.5, 1}; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["marks"].push_back(json["points"][0]["marks"][0]); }));
  EXPECT_FALSE(refused([](auto& json) { json["points"][0]["marks"][0]["pixel"] = {640.0, 400.0}; }));
}

TEST(CheckDocument, MarksInPhotosThatHaveLeftTheSurveyMayStay) {
  SampleProject sample;
  const std::filesystem::path list = sample.photos / "gcp_list.txt";
  base::WriteFileAtomically(list, "EPSG:32632\n1 2 3 10 20 gone.jpg a\n1 2 3 30 40 img_1.JPG a\n1 2 3 9999 40 IMG_0.jpg a\n");
  ProjectData data(sample.project);
  nlohmann::json gcp = base::ParseJson(data.Get("gcp.json", "").body);
  EXPECT_EQ(gcp["skipped"], 1) << "outside the photo";
  ASSERT_EQ(gcp["points"][0]["marks"].size(), 2U);
  EXPECT_EQ(gcp["points"][0]["marks"][0]["unknown"], true);
  EXPECT_EQ(gcp["points"][0]["marks"][1]["photo"], "IMG_1.jpg");
  gcp["points"][0]["marks"][0].erase("unknown");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(data.Put("gcp.json", base::JsonText(gcp), "").status, 204);
  EXPECT_NE(base::ReadFile(sample.project.folder / "gcp_list.txt").find("gone.jpg a"), std::string::npos);
  EXPECT_NE(base::ReadFile(list).find("9999"), std::string::npos) << "the list beside the photos is not ours";
  gcp["points"][0]["marks"][0]["photo"] = "gone_too.jpg";
  EXPECT_EQ(data.Put("gcp.json", base::JsonText(gcp), "").status, 400);
  gcp["points"][0]["marks"][0]["unknown"] = "yes";
  EXPECT_EQ(data.Put("gcp.json", base::JsonText(gcp), "").status, 400);
  gcp["points"][0]["marks"][0]["unknown"] = true;
  EXPECT_EQ(data.Put("gcp.json", base::JsonText(gcp), "").status, 204) << "the page takes a deletion back";
}

TEST(CheckDocument, ADamagedOldDocumentDoesNotPreventSaving) {
  SampleProject sample;
  ProjectData data(sample.project);
  const std::string deep(200'000, '[');
  for (const std::string& old :
       {std::string("{"), std::string("[]"), std::string(R"({"points": [{}]})"), std::string(R"({"points": [{"marks": [{"photo": 1}]}]})"), deep}) {
    base::WriteFileAtomically(sample.project.folder / "gcp.json", old);
    base::WriteFileAtomically(sample.project.folder / "gcp_list.txt", "EPSG:32632\n");
    EXPECT_EQ(data.Put("gcp.json", base::JsonText(OnePoint()), "").status, 204) << old.substr(0, 40);
  }
}

// Deeper than any stack: it must be refused before anything follows the nesting.
TEST(CheckDocument, DeepNestingIsRefused) {
  SampleProject sample;
  ProjectData data(sample.project);
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  for (const char* name : {"measurements.geojson", "gcp.json", "camera_path.json"}) {
    EXPECT_EQ(data.Put(name, std::string(500'000, '[') + std::string(500'000, ']'), "").status, 400);
    EXPECT_EQ(data.Put(name, objects, "").status, 400);
  }
  const std::string in_text = R"({"type": "FeatureCollection", "features": [], "note": "\")" + std::string(100, '[') + "\"}";
  EXPECT_EQ(data.Put("measurements.geojson", in_text, "").status, 204) << "brackets in texts are no nesting";
}

TEST(CheckDocument, GeometriesHaveTheShapeOfTheirType) {
  SampleProject sample;
  ProjectData data(sample.project);
  const auto status = [&](const std::string& type, const std::string& coordinates, const std::string& name = "a") {
    const std::string feature = R"({"type": "Feature", "properties": {"name": ")" + name + R"("}, "geometry": {"type": ")" + type +
                                R"(", "coordinates": )" + coordinates + "}}";
    return data.Put("measurements.geojson", R"({"type": "FeatureCollection", "features": [)" + feature + "]}", "").status;
  };
  EXPECT_EQ(status("Point", "[1, 2, 3]"), 204);
  EXPECT_EQ(status("Point", "[[1, 2, 3]]"), 400);
  EXPECT_EQ(status("LineString", "[[1, 2], [3, 4]]"), 204);
  EXPECT_EQ(status("LineString", "[[1, 2]]"), 400);
  EXPECT_EQ(status("Polygon", "[[[1, 2], [3, 4], [5, 6], [1, 2]]]"), 204);
  EXPECT_EQ(status("Polygon", "[[1, 2], [3, 4], [5, 6], [1, 2]]"), 400);
  EXPECT_EQ(status("Polygon", "[]"), 400);
  EXPECT_EQ(status("Circle", "[1, 2]"), 400);
  EXPECT_EQ(status("Point", "[1, 2]", std::string(900, 'x')), 400);
}

TEST(CheckDocument, AnEmptyCameraPathIsNone) {
  SampleProject sample;
  ProjectData data(sample.project);
  const std::filesystem::path file = sample.project.folder / "camera_path.json";
  EXPECT_EQ(data.Put("camera_path.json", R"([{"position_enu": [1, 2, 3]}])", "").status, 204);
  EXPECT_TRUE(std::filesystem::exists(file));
  for (int i = 0; i < 2; ++i) EXPECT_EQ(data.Put("camera_path.json", R"({"views": [], "frames_between": 3})", "").status, 204);
  EXPECT_FALSE(std::filesystem::exists(file)) << "`render --path` would refuse it";
  EXPECT_EQ(data.Get("camera_path.json", "").status, 204);
}

// What is saved can be read by `skyquilt render --path`.
TEST(CheckDocument, CameraPathsAreThoseThatRenderReads) {
  SampleProject sample;
  ProjectData data(sample.project);
  EXPECT_EQ(data.Put("camera_path.json", R"({"views": [{"position_enu": [1, 2, 3], "name": "a"}, {"position_enu": [5, 2, 3], "name": "b"}],
                                            "frames_between": 5, "skyquilt": {"speed": 3}})",
                     "")
                .status,
            204);
  const scene::SceneInfo info;
  EXPECT_EQ(products::LoadCameraPath(sample.project.folder / "camera_path.json", info, 64, 36).size(), 7U);
  for (const char* wrong : {R"("fov": 180)", R"("name": "../a")", R"("name": "")", R"("yaw": "north")", R"("yaw": 1e999)", R"("speed": 2)"}) {
    EXPECT_EQ(data.Put("camera_path.json", std::string(R"([{"position_enu": [1, 2, 3], )") + wrong + "}]", "").status, 400) << wrong;
  }
  EXPECT_EQ(data.Put("camera_path.json", R"([{"position_enu": [1, 2, 3], "name": "a"}, {"position_enu": [1, 2, 3], "name": "a"}])", "").status, 400);
  EXPECT_EQ(data.Put("camera_path.json", R"({"views": [{"position_enu": [1, 2, 3]}], "frames_between": -1})", "").status, 400);
  // Frames are made when a path is read, so their number is limited.
  std::string many = R"({"frames_between": 10000, "views": [{"position_enu": [1, 2, 3]})";
  for (int i = 0; i < 5000; ++i) many += R"(,{"position_enu": [1, 2, 3]})";
  EXPECT_EQ(data.Put("camera_path.json", many + "]}", "").status, 400);
}

}  // namespace
}  // namespace skyquilt::viewer
