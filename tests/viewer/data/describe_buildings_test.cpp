// Buildings as the viewer offers them: their number, their files, and the reason when there are none.
#include <gtest/gtest.h>

#include "coordinator/project/stamp.h"
#include "tests/viewer/data/sample_project.h"

namespace skyquilt::viewer {
namespace {

using DescribeBuildings = SampleProjectTest;

// As 'skyquilt buildings' writes it, with members that only look like the list of buildings.
constexpr const char* kTwoBuildings = R"({"format": "skyquilt buildings", "version": 1, "metric": true, "other": [{"id": 9}], "buildings": [)"
                                      R"({"id": 1, "shape": {"parts": [{"u0": 0}, {"u0": 1}]}, "buildings": [{}, {}]}, {"id": 2}]})";

void Write(const SampleProject& sample, const std::string& name, const std::string& content) {
  std::filesystem::create_directories(sample.project.BuildingsFolder());
  base::WriteFileAtomically(sample.project.BuildingsFolder() / name, content);
}

nlohmann::json MissingOf(const nlohmann::json& description) {
  for (const nlohmann::json& one : description["missing"]) {
    if (one["what"] == "buildings") return one;
  }
  return nullptr;
}

TEST_F(DescribeBuildings, CountsThemAndListsTheirFiles) {
  Write(sample_, "buildings.json", kTwoBuildings);
  Write(sample_, "buildings.csv", "id\n1\n2\n");
  Write(sample_, "buildings.gpkg", "GPKG");
  Write(sample_, "notes.txt", "private");
  ProjectData data(sample_.project);
  const nlohmann::json description = DescriptionOf(data);
  EXPECT_EQ(description["buildings"],
            (nlohmann::json{{"count", 2}, {"url", "buildings/buildings.json"}, {"files", {"buildings/buildings.csv", "buildings/buildings.gpkg"}}}));
  EXPECT_TRUE(MissingOf(description).is_null());
  const DataReply table = data.Get("buildings/buildings.json", "r=0");
  EXPECT_EQ(table.status, 200);
  EXPECT_EQ(table.content_type, "application/json");
  EXPECT_EQ(table.file, sample_.project.BuildingsFile());
  EXPECT_TRUE(table.cache);
  EXPECT_EQ(data.Get("buildings/buildings.csv", "").content_type, "text/csv; charset=utf-8");
  for (const char* path : {"buildings/notes.txt", "buildings/buildings.dxf", "buildings/", "buildings/../config.toml", "buildings"}) {
    EXPECT_EQ(data.Get(path, "").status, 404) << path;
  }
}

TEST_F(DescribeBuildings, ASurveyWithoutBuildingsHasNone) {
  Write(sample_, "buildings.json", R"({"format": "skyquilt buildings", "version": 1, "buildings": []})");
  ProjectData data(sample_.project);
  EXPECT_EQ(DescriptionOf(data)["buildings"]["count"], 0);
}

TEST_F(DescribeBuildings, SaysWhichCommandMakesThem) {
  const std::string command = "skyquilt buildings " + sample_.project.folder.string();
  EXPECT_TRUE(DescriptionOf(data_)["buildings"].is_null());
  EXPECT_EQ(MissingOf(DescriptionOf(data_))["advice"], "skyquilt surface " + sample_.project.folder.string() + "\n" + command)
      << "without a surface none can be found";
  sample_.AddSurface();
  data_.Reload();
  EXPECT_EQ(MissingOf(DescriptionOf(data_))["advice"], command);
  EXPECT_EQ(data_.Get("buildings/buildings.json", "").status, 404);
  coordinator::SaveStamp(sample_.project, {.stage = "buildings", .state = coordinator::StageStamp::kRunning, .options = {}, .inputs = {}});
  data_.Reload();
  EXPECT_NE(MissingOf(DescriptionOf(data_))["reason"].get<std::string>().find("interrupted"), std::string::npos);
}

TEST_F(DescribeBuildings, WhatIsDamagedIsNotServed) {
  sample_.AddSurface();
  const std::string whole = kTwoBuildings;
  for (const std::string& content : {std::string(), whole.substr(0, whole.size() - 1), std::string("[]"), std::string(R"({"buildings": []})"),
                                     std::string(R"({"format": "skyquilt buildings", "version": 2, "buildings": []})"),
                                     std::string(R"({"format": "skyquilt buildings", "version": 1, "buildings": {}})"), std::string("\xff\xfe{}")}) {
    Write(sample_, "buildings.json", content);
    Write(sample_, "buildings.csv", "id\n");
    ProjectData data(sample_.project);
    EXPECT_TRUE(DescriptionOf(data)["buildings"].is_null()) << content;
    EXPECT_EQ(MissingOf(DescriptionOf(data))["advice"], "skyquilt buildings " + sample_.project.folder.string() + " --restart") << content;
    EXPECT_EQ(data.Get("buildings/buildings.json", "").status, 404);
    EXPECT_EQ(data.Get("buildings/buildings.csv", "").status, 404);
  }
}

TEST_F(DescribeBuildings, TooManyForABrowserAreForAGis) {
  Write(sample_, "buildings.json", kTwoBuildings);
  std::filesystem::resize_file(sample_.project.BuildingsFile(), (64U << 20U) + 1U);  // sparse, takes no room
  ProjectData data(sample_.project);
  EXPECT_TRUE(DescriptionOf(data)["buildings"].is_null());
  EXPECT_NE(MissingOf(DescriptionOf(data))["advice"].get<std::string>().find("buildings.gpkg"), std::string::npos);
  EXPECT_EQ(data.Get("buildings/buildings.json", "").status, 404);
}

TEST_F(DescribeBuildings, LinksAreNotFollowed) {
  Write(sample_, "buildings.json", kTwoBuildings);
  base::WriteFileAtomically(sample_.folder / "private", "private");
  std::filesystem::create_symlink(sample_.folder / "private", sample_.project.BuildingsFolder() / "buildings.csv");
  ProjectData data(sample_.project);
  EXPECT_TRUE(DescriptionOf(data)["buildings"]["files"].empty());
  EXPECT_EQ(data.Get("buildings/buildings.csv", "").status, 404);
}

TEST_F(DescribeBuildings, ThoseOfTheEarlierProjectHaveTheirOwnUrls) {
  SampleProject sample, earlier;
  Write(earlier, "buildings.json", kTwoBuildings);
  Write(earlier, "buildings.dxf", "0\nEOF\n");
  ProjectData data(sample.project, earlier.project);
  const nlohmann::json before = DescriptionOf(data)["before"]["buildings"];
  EXPECT_EQ(before["url"], "before/buildings/buildings.json");
  EXPECT_EQ(before["files"], nlohmann::json({"before/buildings/buildings.dxf"}));
  EXPECT_EQ(data.Get("before/buildings/buildings.dxf", "").file, earlier.project.BuildingsFolder() / "buildings.dxf");
}

}  // namespace
}  // namespace skyquilt::viewer
