// Saving what people make: checks, atomic replacement, and gcp_list.txt beside gcp.json.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "core/base/json_text.h"
#include "tests/viewer/data/sample_project.h"

namespace skyquilt::viewer {
namespace {

std::string Points(size_t count) {
  nlohmann::json json = {{"type", "FeatureCollection"}, {"features", nlohmann::json::array()}, {"skyquilt", {{"version", 1}}}};
  for (size_t i = 0; i < count; ++i) {
    json["features"].push_back({{"type", "Feature"},
                                {"properties", {{"name", "p" + std::to_string(i)}, {"own", 7}}},
                                {"geometry", {{"type", "Point"}, {"coordinates", {8.5, 47.3, 400.0 + static_cast<double>(i)}}}}});
  }
  return base::JsonText(json);
}

nlohmann::json Gcps() {
  return base::ParseJson(R"({"crs": "EPSG:32632", "points": [
    {"name": "GCP 1", "x": 465400.5, "y": 5247100.25, "z": 410, "marks": [{"photo": "IMG_0.jpg", "pixel": [100.5, 200.25]}]},
    {"name": "later", "x": 1, "y": 2, "z": 3, "marks": []}]})");
}

TEST(Documents, AreAbsentThenSavedThenRead) {
  SampleProject sample;
  ProjectData data(sample.project);
  EXPECT_EQ(data.Get("measurements.geojson", "").status, 204);
  EXPECT_EQ(data.Put("measurements.geojson", Points(3), "").status, 204);
  const nlohmann::json read = base::ParseJson(data.Get("measurements.geojson", "").body);
  EXPECT_EQ(read, base::ParseJson(Points(3))) << "nothing is lost, also what the server does not know";
  EXPECT_TRUE(std::filesystem::exists(sample.project.folder / "measurements.geojson"));
}

TEST(Documents, RefusesWhatIsNotOne) {
  SampleProject sample;
  ProjectData data(sample.project);
  ASSERT_EQ(data.Put("measurements.geojson", Points(1), "").status, 204);
  const std::string deep = std::string(100, '[') + std::string(100, ']');
  for (
      const std::string& wrong :
      {std::string("{"), std::string("[]"), std::string(R"({"type": "FeatureCollection"})"), deep,
       std::string(R"({"type": "FeatureCollection", "features": [1]})"),
       std::string(R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": null}]})"),
       std::string(
           R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": ["a", 1]}}]})"),
       std::string(
           R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [1e300, 1]}}]})"),
       Points(5001)}) {
    const DataReply reply = data.Put("measurements.geojson", wrong, "");
    EXPECT_EQ(reply.status, 400) << wrong.substr(0, 80);
    EXPECT_NE(reply.body.find("not saved"), std::string::npos);
  }
  EXPECT_EQ(base::ParseJson(data.Get("measurements.geojson", "").body)["features"].size(), 1U) << "the old file stays";
}

TEST(Documents, ControlPointsAreAlsoWrittenForOtherPrograms) {
  SampleProject sample;
  ProjectData data(sample.project);
  const std::filesystem::path list = sample.project.folder / "gcp_list.txt";
  base::WriteFileAtomically(list, "EPSG:32632\n465400.5 5247100.25 410 1 2 IMG_1.jpg old\n");
  const nlohmann::json converted = base::ParseJson(data.Get("gcp.json", "").body);
  EXPECT_EQ(converted["points"][0]["name"], "old");
  EXPECT_EQ(data.Put("gcp.json", base::JsonText(Gcps()), "").status, 204);
  EXPECT_EQ(base::ReadFile(list),
            "EPSG:32632\n465400.5000 5247100.2500 410.0000 100.00 199.75 IMG_0.jpg GCP_1\n# no marks yet: 1.0000 2.0000 3.0000 later\n");
  EXPECT_NE(base::ReadFile(sample.project.folder / "gcp_list.txt.orig").find("old"), std::string::npos) << "a list from elsewhere is kept";
  nlohmann::json changed = Gcps();
  changed["points"].erase(1);
  EXPECT_EQ(data.Put("gcp.json", base::JsonText(changed), "").status, 204);
  EXPECT_EQ(base::ReadFile(list).find("later"), std::string::npos);
  EXPECT_NE(base::ReadFile(sample.project.folder / "gcp_list.txt.orig").find("old"), std::string::npos) << "and not replaced by our own";
  EXPECT_EQ(base::ParseJson(data.Get("gcp.json", "").body), changed);
}

TEST(Documents, ListsThatAPageSendsAreConvertedAndNotSaved) {
  SampleProject sample;
  ProjectData data(sample.project);
  const DataReply reply = data.Put("gcp_list.txt", "EPSG:32632\n465400.5 5247100.25 410 1 2 IMG_1.jpg\n", "");
  ASSERT_EQ(reply.status, 200);
  EXPECT_EQ(base::ParseJson(reply.body), base::ParseJson(R"({"crs": "EPSG:32632", "points": [
    {"name": "", "x": 465400.5, "y": 5247100.25, "z": 410.0, "marks": [{"photo": "IMG_1.jpg", "pixel": [1.5, 2.5]}]}]})"));
  EXPECT_FALSE(std::filesystem::exists(sample.project.folder / "gcp_list.txt"));
  EXPECT_EQ(data.Get("gcp.json", "").status, 204);
  const DataReply refused = data.Put("gcp_list.txt", "1 2 3 1 2 IMG_1.jpg\n", "");
  EXPECT_EQ(refused.status, 400);
  EXPECT_EQ(refused.body, "does not begin with a coordinate system. Write it in the first line, for instance EPSG:32632");
}

TEST(Documents, EveryListFromElsewhereIsKept) {
  SampleProject sample;
  ProjectData data(sample.project);
  const std::filesystem::path list = sample.project.folder / "gcp_list.txt";
  const std::string first = "EPSG:32632\n1 2 3 1 2 IMG_1.jpg first\n", second = "EPSG:32632\n1 2 3 1 2 IMG_1.jpg second\n";
  for (const std::string& theirs : {first, second, first, second}) {
    base::WriteFileAtomically(list, theirs);
    ASSERT_EQ(data.Put("gcp.json", base::JsonText(Gcps()), "").status, 204);
  }
  EXPECT_EQ(base::ReadFile(sample.project.folder / "gcp_list.txt.orig"), first);
  EXPECT_EQ(base::ReadFile(sample.project.folder / "gcp_list.txt.orig.2"), second);
  EXPECT_FALSE(std::filesystem::exists(sample.project.folder / "gcp_list.txt.orig.3"));
}

TEST(Documents, TwoWindowsDoNotOverwriteEachOther) {
  SampleProject sample;
  ProjectData data(sample.project);
  const std::pair<const char*, std::array<std::string, 2>> documents[] = {
      {"measurements.geojson", {Points(1), Points(2)}},
      {"gcp.json", {base::JsonText(Gcps()), R"({"crs": "EPSG:32632", "points": []})"}},
      {"camera_path.json", {R"([{"position_enu": [1, 2, 3]}])", R"({"views": [], "frames_between": 3})"}}};
  for (const auto& [name, bodies] : documents) {
    const std::string none = data.Get(name, "").etag;
    EXPECT_EQ(none, base::HashHex(""));
    const DataReply saved = data.Put(name, bodies[0], none);
    ASSERT_EQ(saved.status, 204) << name;
    EXPECT_EQ(saved.etag, base::HashHex(base::ReadFile(sample.project.folder / name)));
    EXPECT_EQ(data.Get(name, "").etag, saved.etag);
    const DataReply late = data.Put(name, bodies[1], none);
    EXPECT_EQ(late.status, 412);
    EXPECT_EQ(late.body, std::string(name) + " was changed in another window. Reload the page to see it");
    EXPECT_EQ(data.Get(name, "").etag, saved.etag) << "nothing was saved";
    const DataReply second = data.Put(name, bodies[1], saved.etag);
    EXPECT_EQ(second.status, 204) << name;
    EXPECT_EQ(second.etag, data.Get(name, "").etag);
  }
}

// Whoever takes a document that cannot be read for none replaces it.
TEST(Documents, WhatCannotBeReadIsNoAbsence) {
  SampleProject sample;
  ProjectData data(sample.project);
  for (const char* name : {"measurements.geojson", "gcp.json", "camera_path.json", "gcp_list.txt"}) {
    const std::filesystem::path file = sample.project.folder / name;
    std::filesystem::create_directories(file / "inside");
    const std::string document = std::string(name) == "gcp_list.txt" ? "gcp.json" : name;
    const DataReply reply = data.Get(document, "");
    EXPECT_EQ(reply.status, 500) << name;
    EXPECT_NE(reply.body.find(name), std::string::npos);
    EXPECT_TRUE(reply.etag.empty());
    const std::string body = document == "gcp.json"           ? base::JsonText(Gcps())
                             : document == "camera_path.json" ? R"([{"position_enu": [1, 2, 3]}])"
                                                              : Points(1);
    EXPECT_EQ(data.Put(document, body, "").status, 500) << name;
    EXPECT_TRUE(std::filesystem::is_directory(file / "inside"));
    EXPECT_EQ(std::filesystem::exists(sample.project.folder / "gcp.json"), std::string(name) == "gcp.json");
    std::filesystem::remove_all(file);
  }
  std::filesystem::create_directories(sample.photos / "gcp_list.txt");
  EXPECT_EQ(data.Get("gcp.json", "").status, 204) << "beside the photos it is never replaced";
}

TEST(Documents, RefusesControlPointsThatCannotBeUsed) {
  SampleProject sample;
  ProjectData data(sample.project);
  const auto refused = [&](const std::function<void(nlohmann::json&)>& spoil) {
    nlohmann::json json = Gcps();
    spoil(json);
    return data.Put("gcp.json", base::JsonText(json), "").status == 400;
  };
  EXPECT_TRUE(refused([](auto& json) { json["points"][1]["name"] = "GCP 1"; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["name"] = ""; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["x"] = nullptr; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["marks"][0]["pixel"] = {1}; }));
  EXPECT_TRUE(refused([](auto& json) { json["points"][0]["marks"][0].erase("photo"); }));
  EXPECT_TRUE(refused([](auto& json) { json["crs"] = "EPSG:1\nevil"; }));
  EXPECT_TRUE(refused([](auto& json) { json.erase("points"); }));
}

TEST(Documents, CameraPathsAreThoseOfRender) {
  SampleProject sample;
  ProjectData data(sample.project);
  const std::string path =
      R"({"views": [{"position_enu": [1, 2, 3], "yaw": 10, "pitch": -20, "fov": 60, "name": "a"}], "frames_between": 5, "skyquilt": {"speed": 3}})";
  EXPECT_EQ(data.Put("camera_path.json", path, "").status, 204);
  EXPECT_EQ(data.Put("camera_path.json", R"([{"position_enu": [1, 2]}])", "").status, 400);
  EXPECT_EQ(data.Put("camera_path.json", R"([{"yaw": 2}])", "").status, 400);
  EXPECT_EQ(data.Put("camera_path.json", R"([{"position_enu": [1, 2, 3], "speed": 2}])", "").status, 400);
}

TEST(Documents, AReadOnlyFolderIsAnAnswer) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  SampleProject sample;
  ProjectData data(sample.project);
  std::filesystem::permissions(sample.project.folder, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_EQ(data.Put("measurements.geojson", Points(1), "").status, 409);
  std::filesystem::permissions(sample.project.folder, std::filesystem::perms::owner_all);
}

TEST(Documents, AreOldOrNewWhenTheProcessIsKilled) {
  SampleProject sample;
  const std::string small = Points(2), large = Points(3000);
  ASSERT_EQ(ProjectData(sample.project).Put("measurements.geojson", small, "").status, 204);
  for (int attempt = 0; attempt < 12; ++attempt) {
    const pid_t child = fork();
    if (child == 0) {
      ProjectData data(sample.project);
      for (;;) {
        data.Put("measurements.geojson", large, "");
        data.Put("measurements.geojson", small, "");
      }
    }
    usleep(static_cast<useconds_t>(20'000 + 7'000 * attempt));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const nlohmann::json saved = base::TryParseJson(base::ReadFile(sample.project.folder / "measurements.geojson"));
    ASSERT_FALSE(saved.is_discarded()) << "half a file";
    const size_t count = saved["features"].size();
    EXPECT_TRUE(count == 2 || count == 3000) << count;
  }
}

}  // namespace
}  // namespace skyquilt::viewer
