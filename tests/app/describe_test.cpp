#include "app/commands/describe.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "coordinator/project/project.h"
#include "core/base/file.h"
#include "core/scene/scene_file.h"
#include "partition/block.h"
#include "tests/support/call_program.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/nadir_photo.h"

namespace skyquilt::app {
namespace {

using DescribeArchiveTest = InTemporaryFolder;
using DescribeProject = InTemporaryFolder;

survey::Survey LaggingSurvey() {
  survey::Survey survey;
  survey.origin = {47.0, 8.0, 400.0};
  survey.georeferenced = true;
  survey.photo_root = "photos";
  survey.cameras.emplace_back();
  survey.cameras[0].model = camera::CameraModel::kPinhole;
  survey.cameras[0].width = 800;
  survey.cameras[0].height = 600;
  survey.cameras[0].params = {700.0, 700.0, 400.0, 300.0};
  survey.photos = {NadirPhoto({0.0, 0.0, 50.0}, "a.jpg")};
  survey.fit.n_matches = 75;
  survey.fit.n_inliers = 18;
  survey.fit.tag_lag_s = 1.23456;
  survey.fit.tag_lag_sigma_s = 0.0456;
  survey.fit.accuracy = {.scale_percent = 0.00041234, .tilt_deg = 0.3, .yaw_deg = 0.0, .horizontal_m = 1.53};
  survey.fit.gravity = {{.kind = "gimbal", .n = 3, .lean_east_deg = 0.1, .lean_north_deg = -0.2, .sigma_deg = 0.25, .weight = 0.9}};
  survey.problems = {{.code = "tags_disagree",
                      .finding = "only 18 of 75 GPS tags agree with each other within the accuracy that they are tagged with",
                      .advice = "look at the tags on the map of the report",
                      .about_place = true}};
  return survey;
}

void ExpectPlace(const nlohmann::ordered_json& place) {
  EXPECT_EQ(place.at("accuracy").at("scale_percent"), 0.000412);
  EXPECT_EQ(place.at("accuracy").at("yaw_deg"), 0.0);
  EXPECT_EQ(place.at("accuracy").at("horizontal_m"), 1.53);
  EXPECT_TRUE(place.at("accuracy").at("vertical_m").is_null());
  EXPECT_EQ(place.at("gps_fit").at("inliers"), 18);
  EXPECT_EQ(place.at("gps_fit").at("tag_lag_s"), 1.235);
  EXPECT_EQ(place.at("gps_fit").at("tag_lag_sigma_s"), 0.0456);
  ASSERT_EQ(place.at("problems").size(), 1U);
  EXPECT_EQ(place.at("problems")[0].at("code"), "tags_disagree");
  EXPECT_EQ(place.at("problems")[0].at("advice"), "look at the tags on the map of the report");
}

TEST(DescribeSurvey, ShowsErrorsOfControlPoints) {
  survey::Survey survey = LaggingSurvey();
  EXPECT_FALSE(DescribePlace(survey).contains("control"));
  survey.control.file = "gcp_list.txt";
  survey.control.placed = true;
  survey::ControlPointFit check, wrong;
  check.label = "c1";
  check.use = survey::ControlUse::kCheck;
  check.error_m = {0.03, 0.04, -0.02};
  check.gsd_m = 0.025;
  wrong.label = "g1";
  wrong.use = survey::ControlUse::kRejected;
  survey.control.points = {check, wrong};
  const nlohmann::ordered_json control = DescribePlace(survey).at("control");
  EXPECT_EQ(control.at("file"), "gcp_list.txt");
  EXPECT_EQ(control.at("check").at("rmse_horizontal_m"), 0.05);
  EXPECT_EQ(control.at("check").at("rmse_horizontal_gsd"), 2.0);
  EXPECT_EQ(control.at("check").at("rmse_vertical_m"), 0.02);
  EXPECT_FALSE(control.contains("control"));
  EXPECT_EQ(control.at("rejected"), nlohmann::ordered_json::array({"g1"}));
  EXPECT_TRUE(control.at("accuracy").get<std::string>().starts_with("There are fewer than 30 check points (1)."));
}

TEST(DescribeSurvey, ShowsAccuracyLagAndProblems) {
  const TemporaryFolder folder;
  survey::SaveSurvey(LaggingSurvey(), folder.path());
  const nlohmann::ordered_json json = Describe(folder.path());
  EXPECT_EQ(json.at("what"), "survey");
  EXPECT_EQ(json.at("photos"), 1);
  ExpectPlace(json);
  EXPECT_EQ(json.at("gravity")[0].at("evidence"), "gimbal");
  EXPECT_EQ(json.at("gravity")[0].at("weight"), 0.9);
}

TEST_F(DescribeProject, ShowsHowWellItsSurveyIsPlaced) {
  survey::SaveSurvey(LaggingSurvey(), folder_ / "survey");
  const nlohmann::ordered_json json = Describe(folder_.path());
  EXPECT_EQ(json.at("what"), "project");
  ExpectPlace(json.at("survey"));

  const Called text = CallProgram({"info", folder_.path().string()});
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.out.find("    horizontal_m: 1.53\n    vertical_m: -\n"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("    tag_lag_s: 1.235\n"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("\n    - code: tags_disagree\n      finding: only 18 of 75"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("\n      advice: look at the tags"), std::string::npos) << text.out;
}

TEST_F(DescribeProject, ShowsItsStagesWhenTheSurveyCannotBeRead) {
  survey::SaveSurvey(LaggingSurvey(), folder_ / "survey");
  base::WriteFileAtomically(folder_ / "survey/survey.json", R"({"format": "skyquilt survey", "version": 1})");
  const nlohmann::ordered_json json = Describe(folder_.path());
  EXPECT_FALSE(json.at("stages").empty());
  EXPECT_NE(json.at("survey").at("unreadable").get<std::string>().find("skyquilt prepare"), std::string::npos) << json;
}

// State of the stage "products".
std::string StateOfProducts(const nlohmann::ordered_json& project) {
  for (const auto& stage : project.at("stages")) {
    if (stage.at("stage") == "products") return stage.at("state").get<std::string>();
  }
  return "";
}

TEST_F(DescribeProject, ShowsThePreviewUntilThereIsTheOrthophoto) {
  survey::SaveSurvey(LaggingSurvey(), folder_ / "survey");
  EXPECT_FALSE(Describe(folder_.path()).contains("previews"));
  std::filesystem::create_directories(folder_ / "products");
  for (const char* name : {"preview_ortho.tif", "preview_ortho.png"}) base::WriteFileAtomically(folder_ / "products" / name, "x");
  base::WriteFileAtomically(folder_ / "products/preview_ortho.json", R"({"preview": "sparse points"})");
  for (const char* name : {"preview_context.tif", "preview_context.png"}) base::WriteFileAtomically(folder_ / "products" / name, "x");
  base::WriteFileAtomically(folder_ / "products/preview_context.json", R"({"preview": "context"})");
  nlohmann::ordered_json json = Describe(folder_.path());
  EXPECT_EQ(json.at("previews").at(0).at("made_from"), "sparse points");
  EXPECT_NE(json.at("previews").at(0).at("picture").get<std::string>().find("products/preview_ortho.png"), std::string::npos);
  EXPECT_EQ(json.at("previews").at(1).at("made_from"), "context");
  EXPECT_EQ(StateOfProducts(json), "not started");
  base::WriteFileAtomically(folder_ / "products/orthophoto.tif", "x");
  json = Describe(folder_.path());
  EXPECT_FALSE(json.contains("previews"));
  EXPECT_NE(json.at("orthophoto").get<std::string>().find("products/orthophoto.tif"), std::string::npos);
}

TEST(DescribeBlocks, ShowsTheAccuracy) {
  const TemporaryFolder folder;
  partition::BlockSet set;
  set.accuracy = {.tilt_deg = 1.2345};
  partition::SaveBlocks(set, folder / "blocks.geojson");
  const nlohmann::ordered_json json = Describe(folder / "blocks.geojson");
  EXPECT_EQ(json.at("accuracy").at("tilt_deg"), 1.23);
  EXPECT_TRUE(json.at("accuracy").at("yaw_deg").is_null());
}

TEST_F(DescribeArchiveTest, ShowsTheAccuracyOfScenesOnly) {
  checkpoint::ArchiveWriter scene(scene::kSceneKind, scene::kSceneVersion);
  scene::PutAccuracy({.horizontal_m = 1.5}, scene);
  scene.SetAttribute("blocks", 0);
  scene.Commit(folder_ / "scene.h5");
  const nlohmann::ordered_json json = Describe(folder_ / "scene.h5");
  EXPECT_EQ(json.at("accuracy").at("horizontal_m"), 1.5);
  EXPECT_TRUE(json.at("accuracy").at("vertical_m").is_null());
  checkpoint::ArchiveWriter("block", 1).Commit(folder_ / "block.h5");
  EXPECT_FALSE(Describe(folder_ / "block.h5").contains("accuracy"));
}

// A scene of one block; multisample 0: of points.
void WriteSceneOf(int multisample, const std::filesystem::path& file) {
  checkpoint::ArchiveWriter scene(scene::kSceneKind, scene::kSceneVersion);
  scene.SetAttribute("blocks", 1);
  if (multisample > 0) {
    scene.SetAttribute("blocks/0/multisample", multisample);
    scene.SetAttribute("blocks/0/footprint_min_m", 0.0123456);
    scene.SetAttribute("blocks/0/footprint_max_m", 0.25);
  }
  scene.Commit(file);
}

TEST_F(DescribeArchiveTest, ShowsTheScalesOfScenesOnly) {
  WriteSceneOf(0, folder_ / "points.h5");
  const nlohmann::ordered_json points = Describe(folder_ / "points.h5").at("scales");
  EXPECT_NE(points.at("samples").get<std::string>().find("points"), std::string::npos);
  EXPECT_FALSE(points.contains("finest_m_per_pixel"));
  WriteSceneOf(6, folder_ / "cones.h5");
  const nlohmann::ordered_json cones = Describe(folder_ / "cones.h5").at("scales");
  EXPECT_EQ(cones.at("samples"), "cones");
  EXPECT_EQ(cones.at("positions"), 6);
  EXPECT_EQ(cones.at("finest_m_per_pixel"), 0.0123);
  EXPECT_EQ(cones.at("coarsest_m_per_pixel"), 0.25);
  checkpoint::ArchiveWriter("block", 1).Commit(folder_ / "block.h5");
  EXPECT_FALSE(Describe(folder_ / "block.h5").contains("scales"));
}

TEST_F(DescribeProject, ShowsTheScalesOfItsScene) {
  survey::SaveSurvey(LaggingSurvey(), folder_ / "survey");
  EXPECT_FALSE(Describe(folder_.path()).contains("scales"));
  const std::filesystem::path file = coordinator::Project{folder_.path()}.SceneFile();
  std::filesystem::create_directories(file.parent_path());
  WriteSceneOf(4, file);
  EXPECT_EQ(Describe(folder_.path()).at("scales").at("positions"), 4);
  const Called text = CallProgram({"info", folder_.path().string()});
  EXPECT_NE(text.out.find("  finest_m_per_pixel: 0.0123\n"), std::string::npos) << text.out;
  base::WriteFileAtomically(file, "not a scene");
  const nlohmann::ordered_json damaged = Describe(folder_.path());
  EXPECT_NE(damaged.at("scales").at("unreadable").get<std::string>().find(file.filename().string()), std::string::npos) << damaged;
  EXPECT_FALSE(damaged.at("stages").empty());
}

TEST(DescribeCameras, ShowTheAccuracyWhereTheFileHasIt) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "cameras.geojson", R"({"features": [], "skyquilt:accuracy": {"tilt_deg": 0.3}})");
  EXPECT_EQ(Describe(folder / "cameras.geojson").at("accuracy").at("tilt_deg"), 0.3);
  base::WriteFileAtomically(folder / "cameras.geojson", R"({"features": []})");
  EXPECT_TRUE(Describe(folder / "cameras.geojson").at("accuracy").is_null());
}

}  // namespace
}  // namespace skyquilt::app
