// Reading a tour before it is saved, and writing it.
#include "tour/format/read_tour.h"

#include <gtest/gtest.h>

#include "core/base/json_text.h"
#include "tests/support/error_of.h"
#include "tests/tour/format/sample_tour.h"
#include "tour/format/write_tour.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::json;

// Why a changed tour is refused; empty when it is not.
std::string Refusal(const std::function<void(Json&)>& change) {
  return ErrorOf<base::Refused>([&] { ParseTour(SampleTourWith(change)); });
}

TEST(ParseTour, ReadsEveryMember) {
  const Tour tour = ParseTour(base::JsonText(SampleTour()));
  EXPECT_EQ(tour.title, "Der Hof, 農場, <script>alert(1)</script>") << "text stays text";
  EXPECT_EQ(tour.start, "gate");
  ASSERT_EQ(tour.stops.size(), 3U);
  const Stop& gate = tour.stops[0];
  EXPECT_EQ(gate.text, "Line 1\nLine 2 <b>&amp;</b>");
  EXPECT_EQ(gate.picture, kSamplePicture);
  EXPECT_EQ(gate.link->url, "https://example.org/a?b=c#d");
  EXPECT_EQ(gate.pose.eye_enu, Eigen::Vector3d(1.25, -2, 30.1));
  EXPECT_EQ(gate.pose.cam_from_enu.w(), 0.5);
  EXPECT_EQ(gate.pose.cam_from_enu.x(), -0.5);
  EXPECT_EQ(gate.exposure_stops, -1.5);
  EXPECT_EQ(gate.layers->at("surface"), true);
  EXPECT_EQ(gate.layers->size(), 2U);
  EXPECT_EQ(gate.measurements, std::vector<std::string>({"m1", "ridge 2"}));
  EXPECT_EQ(gate.pause_s, 8.0);
  EXPECT_FALSE(gate.next->to);
  EXPECT_EQ(gate.next->path.kind, PathKind::kOrbit);
  EXPECT_EQ(gate.next->path.about, Eigen::Vector3d(0, 0, 5));
  EXPECT_EQ(gate.branches.at(0).to, "roof");
  EXPECT_EQ(tour.stops[1].next->to, "gate");
  EXPECT_FALSE(tour.stops[2].next);
  EXPECT_TRUE(tour.stops[2].layers->empty());
  EXPECT_FALSE(tour.stops[1].layers);
  ASSERT_EQ(tour.things.size(), 4U);
  EXPECT_FALSE(tour.things[0].stops);
  EXPECT_EQ(tour.things[1].to, "roof");
  EXPECT_TRUE(tour.things[2].stops->empty());
  EXPECT_EQ(tour.things[3].asset, kSampleModel);
  EXPECT_EQ(tour.things[3].scale, 0.001);
  EXPECT_EQ(tour.assets.at(kSamplePicture).name, "house & garden.JPG");
}

TEST(ParseTour, WhatIsWrittenIsTheSameAgain) {
  const std::string text = FormatTour(ParseTour(base::JsonText(SampleTour())));
  EXPECT_EQ(Json::parse(text), SampleTour());
  EXPECT_EQ(FormatTour(ParseTour(text)), text);
  EXPECT_NO_THROW(ParseTour(FormatTour(Tour{}))) << "a tour without stops may be saved";
}

TEST(ParseTour, TextsOfAnyScriptSurvive) {
  for (const std::string& title :
       {std::string("</script><script>"), std::string("' OR 1=1"), std::string("العربية עברית"), std::string("🏠\xC2\xA0"), std::string(200, 'x')}) {
    const std::string text = SampleTourWith([&](Json& json) { json["stops"][0]["title"] = title; });
    EXPECT_EQ(ParseTour(FormatTour(ParseTour(text))).stops[0].title, title);
  }
  std::string wide;
  for (int i = 0; i < 200; ++i) wide += "東";
  EXPECT_EQ(Refusal([&](Json& json) { json["title"] = wide; }), "") << "characters count, not bytes";
  EXPECT_NE(Refusal([&](Json& json) { json["title"] = wide + "東"; }), "");
}

// One that loses the limits of a member would pass one of these.
TEST(ParseTour, NamesThePathAndTheRule) {
  const struct {
    const char* pointer;  // of the member that is changed
    Json value;
    const char* path;  // that the message begins with
  } cases[] = {
      {"/version", 2, "version "},
      {"/version", "1", "version "},
      {"/title", nullptr, "title "},
      {"/title", "two\nlines", "title "},
      {"/title", "two\u2028lines", "title "},
      {"/start", "nowhere", "start "},
      {"/start", 7, "start "},
      {"/stops", Json::object(), "stops "},
      {"/stops/1", 3, "stops[1] "},
      {"/stops/1/id", "gate", "stops[1].id "},
      {"/stops/1/id", "a b", "stops[1].id "},
      {"/stops/1/id", "", "stops[1].id "},
      {"/stops/1/id", std::string(41, 'a'), "stops[1].id "},
      {"/stops/1/title", "", "stops[1].title "},
      {"/stops/1/text", "bell\a", "stops[1].text "},
      {"/stops/1/text", std::string(10'001, 'a'), "stops[1].text "},
      {"/stops/0/picture", kSampleModel, "stops[0].picture "},
      {"/stops/0/picture", "../../etc/passwd.jpg", "stops[0].picture "},
      {"/stops/0/picture", std::string(64, 'c') + ".png", "stops[0].picture "},
      {"/stops/0/link/url", "javascript:alert(1)", "stops[0].link.url "},
      {"/stops/0/link/url", "data:text/html,x", "stops[0].link.url "},
      {"/stops/0/link/url", "https://", "stops[0].link.url "},
      {"/stops/0/link/url", "https:///x", "stops[0].link.url "},
      {"/stops/0/link/url", "https://a b", "stops[0].link.url "},
      {"/stops/0/link/url", " https://a", "stops[0].link.url "},
      {"/stops/0/link/url", "https://" + std::string(2000, 'a'), "stops[0].link.url "},
      {"/stops/0/link/label", "", "stops[0].link.label "},
      {"/stops/0/link/target", "_top", "stops[0].link.target "},
      {"/stops/0/pose/eye_enu", {1, 2}, "stops[0].pose.eye_enu "},
      {"/stops/0/pose/eye_enu", {1, 2, 1.1e9}, "stops[0].pose.eye_enu "},
      {"/stops/0/pose/eye_enu", {1, 2, "3"}, "stops[0].pose.eye_enu "},
      {"/stops/0/pose/rotation", {1, 0, 0, 0.01}, "stops[0].pose.rotation "},
      {"/stops/0/pose/rotation", {0, 0, 0, 0}, "stops[0].pose.rotation "},
      {"/stops/0/pose/rotation", {1, 0, 0}, "stops[0].pose.rotation "},
      {"/stops/0/pose/fovy_deg", 9.99, "stops[0].pose.fovy_deg "},
      {"/stops/0/pose/fovy_deg", 120.01, "stops[0].pose.fovy_deg "},
      {"/stops/0/exposure_stops", 10.5, "stops[0].exposure_stops "},
      {"/stops/0/layers/roads", true, "stops[0].layers.roads "},
      {"/stops/0/layers/surface", 1, "stops[0].layers.surface "},
      {"/stops/0/measurements", Json(std::vector<std::string>(101, "m")), "stops[0].measurements "},
      {"/stops/0/pause_s", -1, "stops[0].pause_s "},
      {"/stops/0/pause_s", 601, "stops[0].pause_s "},
      {"/stops/0/next/to", "l1", "stops[0].next.to "},
      {"/stops/0/next/path/kind", "fly", "stops[0].next.path.kind "},
      {"/stops/0/next/path/about", nullptr, "stops[0].next.path.about "},
      {"/stops/0/next/path", {{"kind", "over"}, {"about", {1, 2, 3}}}, "stops[0].next.path.about "},
      {"/stops/0/branches/0/to", "nowhere", "stops[0].branches[0].to "},
      {"/stops/0/branches/0/to", nullptr, "stops[0].branches[0].to "},
      {"/stops/0/branches/0/label", "", "stops[0].branches[0].label "},
      {"/stops/0/speed", 3, "stops[0].speed "},
      {"/things/0/kind", "film", "things[0].kind "},
      {"/things/0/id", "gate", "things[0].id "},
      {"/things/0/to", "gate", "things[0].to "},
      {"/things/0/stops", {"l1"}, "things[0].stops "},
      {"/things/1/to", "nowhere", "things[1].to "},
      {"/things/3/scale", 0, "things[3].scale "},
      {"/things/3/yaw_deg", 361, "things[3].yaw_deg "},
      {"/things/3/asset", kSamplePicture, "things[3].asset "},
      {"/things/3/asset", std::string(64, 'c') + ".glb", "things[3].asset "},
      {"/assets/x.glb", {{"name", "x"}, {"bytes", 1}}, "assets "},
      {"/own", 1, "own "},
  };
  for (const auto& [pointer, value, path] : cases) {
    const std::string refusal = Refusal([&, &where = pointer, &what = value](Json& json) { json[Json::json_pointer(where)] = what; });
    EXPECT_TRUE(refusal.starts_with(path)) << pointer << " = " << base::JsonText(value).substr(0, 60) << ": " << refusal;
    EXPECT_GT(refusal.size(), std::string(path).size() + 10) << refusal;
  }
  EXPECT_TRUE(Refusal([](Json& json) { json["assets"][kSampleModel]["bytes"] = 0; }).starts_with("assets." + kSampleModel + ".bytes "));
  EXPECT_TRUE(Refusal([](Json& json) { json["assets"].erase(kSampleModel); }).starts_with("things[3].asset "));
}

TEST(ParseTour, MembersMayBeMissingOnlyWhereThatMeansNothing) {
  for (const char* path : {"/version",
                           "/stops",
                           "/stops/0/id",
                           "/stops/0/title",
                           "/stops/0/pose",
                           "/stops/0/pose/eye_enu",
                           "/stops/0/pose/rotation",
                           "/stops/0/pose/fovy_deg",
                           "/stops/0/link/label",
                           "/stops/0/link/url",
                           "/stops/0/next/path",
                           "/stops/0/next/path/kind",
                           "/stops/0/next/path/about",
                           "/stops/0/branches/0/to",
                           "/stops/0/branches/0/label",
                           "/stops/0/branches/0/path",
                           "/things/0/id",
                           "/things/0/kind",
                           "/things/0/at",
                           "/things/0/text",
                           "/things/1/text",
                           "/things/3/yaw_deg",
                           "/things/3/scale",
                           "/things/3/name",
                           "/things/3/asset"}) {
    const Json::json_pointer pointer(path);
    EXPECT_NE(Refusal([&](Json& json) { json[pointer.parent_pointer()].erase(pointer.back()); }), "") << path;
  }
  const Tour tour = ParseTour(SampleTourWith([](Json& json) {
    for (const char* key : {"title", "start"}) json.erase(key);
    for (const char* key : {"text", "picture", "link", "exposure_stops", "layers", "measurements", "pause_s", "next", "branches"}) {
      json["stops"][0].erase(key);
    }
    for (const char* key : {"to", "stops"}) json["things"][1].erase(key);
  }));
  const Json written = Json::parse(FormatTour(tour));
  EXPECT_EQ(written["stops"][0]["next"], nullptr);
  EXPECT_EQ(written["stops"][0]["pause_s"], 0);
  EXPECT_EQ(written["stops"][0]["branches"], Json::array());
  EXPECT_EQ(written["things"][1]["stops"], nullptr);
  EXPECT_EQ(written.size(), SampleTour().size()) << "all are written";
  EXPECT_EQ(written["stops"][0].size(), SampleTour()["stops"][0].size());
}

TEST(ParseTour, NumbersAndSizesAreLimited) {
  EXPECT_NE(Refusal([](Json& json) {
              for (int i = 0; i < 200; ++i) {
                json["stops"].push_back(json["stops"][2]);
                json["stops"].back()["id"] = "s" + std::to_string(i);
              }
            }).find("at most 200"),
            std::string::npos);
  EXPECT_NE(Refusal([](Json& json) {
              for (int i = 0; i < 500; ++i) {
                json["things"].push_back(json["things"][0]);
                json["things"].back()["id"] = "t" + std::to_string(i);
              }
            }).find("at most 500"),
            std::string::npos);
  EXPECT_NE(
      Refusal([](Json& json) { json["stops"][0]["branches"] = Json(std::vector<Json>(21, json["stops"][0]["branches"][0])); }).find("at most 20"),
      std::string::npos);
  EXPECT_THROW(ParseTour(base::JsonText(SampleTour()) + std::string(kMaxTourBytes, ' ')), base::Refused);
  EXPECT_THROW(ParseTour(std::string(1000, '[')), base::Refused);
  EXPECT_THROW(ParseTour("[]"), base::Refused);
  EXPECT_THROW(ParseTour(""), base::Refused);
}

// Indented it would be longer than may be read again.
TEST(FormatTour, StaysBelowTheLimit) {
  Tour tour;
  for (int i = 0; i < 95; ++i) {
    Stop stop;
    stop.id = "s" + std::to_string(i);
    stop.title = "t";
    stop.text = std::string(10'000, 'x');
    stop.measurements = std::vector<std::string>(100, "m");
    tour.stops.push_back(stop);
  }
  const std::string text = FormatTour(tour);
  EXPECT_GT(text.size(), kMaxTourBytes - 65'536);
  EXPECT_LE(text.size(), kMaxTourBytes);
  EXPECT_EQ(ParseTour(text).stops.size(), 95U);
}

}  // namespace
}  // namespace skyquilt::tour
