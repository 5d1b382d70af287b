// What is played of tours that are not whole.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/error_of.h"
#include "tests/tour/format/sample_tour.h"
#include "tour/format/read_tour.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::json;

PlayableTour Play(const std::function<void(Json&)>& change, const std::string& absent = "") {
  return ReadTourToPlay(SampleTourWith(change), [&](const std::string& name, uint64_t) { return name != absent; });
}

bool Says(const PlayableTour& playable, const std::string& words) {
  return std::any_of(playable.missing.begin(), playable.missing.end(),
                     [&](const std::string& sentence) { return sentence.find(words) != std::string::npos && sentence.ends_with("."); });
}

TEST(PlayableTour, AWholeOneMissesNothing) {
  const PlayableTour playable = Play([](Json&) {});
  EXPECT_TRUE(playable.missing.empty());
  EXPECT_EQ(playable.tour.stops.size(), 3U);
  EXPECT_EQ(playable.tour.things.size(), 4U);
}

TEST(PlayableTour, MissingAssetsAreLeftOutByName) {
  const PlayableTour no_picture = Play([](Json&) {}, kSamplePicture);
  EXPECT_FALSE(no_picture.tour.stops[0].picture);
  EXPECT_TRUE(Says(no_picture, "house & garden.JPG"));
  EXPECT_TRUE(Says(no_picture, "The gate"));
  EXPECT_EQ(no_picture.missing.size(), 1U);
  EXPECT_FALSE(no_picture.tour.assets.contains(kSamplePicture));
  const PlayableTour no_model = Play([](Json&) {}, kSampleModel);
  EXPECT_EQ(no_model.tour.things.size(), 3U);
  EXPECT_TRUE(Says(no_model, "\"Shed\"") && Says(no_model, "shed.glb"));
  EXPECT_TRUE(Says(Play([](Json& json) { json["assets"] = Json::object(); }), "\"Shed\"")) << "not listed";
}

TEST(PlayableTour, ReferencesThatLeadNowhereAreLeftOut) {
  const PlayableTour playable = Play([](Json& json) {
    json["start"] = "gone";
    json["stops"][0]["branches"][0]["to"] = "gone";
    json["stops"][1]["next"]["to"] = "l1";
    json["things"][1]["to"] = "gone";
    json["things"][3]["stops"] = {"gone", "end"};
    json["things"][0]["stops"] = {"gone"};
  });
  EXPECT_FALSE(playable.tour.start);
  EXPECT_TRUE(playable.tour.stops[0].branches.empty());
  EXPECT_TRUE(playable.tour.stops[1].next && !playable.tour.stops[1].next->to);
  ASSERT_EQ(playable.tour.things.size(), 3U);
  EXPECT_FALSE(playable.tour.things[0].to);
  EXPECT_EQ(*playable.tour.things[2].stops, std::vector<std::string>({"end"}));
  for (const char* name : {"first stop", "To the roof", "The roof", "\"Up\"", "A <i>label</i>"}) EXPECT_TRUE(Says(playable, name)) << name;
  EXPECT_EQ(playable.missing.size(), 5U);
}

TEST(PlayableTour, SecondsOfAnIdAreLeftOut) {
  const PlayableTour playable = Play([](Json& json) {
    json["stops"][2]["id"] = "roof";
    json["things"][0]["id"] = "gate";
    json["things"][3]["stops"] = nullptr;
  });
  EXPECT_EQ(playable.tour.stops.size(), 2U);
  EXPECT_EQ(playable.tour.things.size(), 3U);
  EXPECT_TRUE(Says(playable, "\"End\"") && Says(playable, "A <i>label</i>"));
}

TEST(PlayableTour, UnknownKindsAndMembersAreLeftOut) {
  const PlayableTour playable = Play([](Json& json) {
    json["things"][0] = {{"id", "film1"}, {"kind", "film"}, {"frames", 3}};
    json["stops"][0]["next"]["path"] = {{"kind", "fly"}, {"speed", 3}};
    json["stops"][1]["layers"] = {{"roads", true}, {"surface", false}};
    json["mood"] = "fine";
  });
  EXPECT_EQ(playable.tour.things.size(), 3U);
  EXPECT_EQ(playable.tour.stops[0].next->path.kind, PathKind::kDirect);
  EXPECT_EQ(playable.tour.stops[1].layers->size(), 1U);
  for (const char* words : {"film1", "\"fly\"", "roads", "mood"}) EXPECT_TRUE(Says(playable, words)) << words;
}

TEST(PlayableTour, OfAnotherVersionWhatIsUnderstoodIsPlayed) {
  const PlayableTour playable = Play([](Json& json) {
    json["version"] = 7;
    json["stops"][0].erase("exposure_stops");
    json["stops"][0]["sound"] = "birds";
    json["stops"][0]["text"] = {{"de", "Hof"}};
    json["stops"][1].erase("pose");
    json["things"][0]["at"] = "north";
    json["assets"]["x.mp3"] = {{"name", "x"}, {"bytes", 1}};
    json["title"] = {"a", "b"};
  });
  EXPECT_TRUE(Says(playable, "version 7"));
  ASSERT_EQ(playable.tour.stops.size(), 2U);
  EXPECT_EQ(playable.tour.stops[0].id, "gate");
  EXPECT_EQ(playable.tour.stops[0].text, "");
  EXPECT_FALSE(playable.tour.stops[0].exposure_stops);
  EXPECT_EQ(playable.tour.stops[0].picture, kSamplePicture);
  EXPECT_EQ(playable.tour.things.size(), 3U);
  EXPECT_TRUE(Says(playable, "stops[1]") && Says(playable, "things[0]"));
  EXPECT_TRUE(Says(playable, "To the roof")) << "the branch to a stop that cannot be read";
  EXPECT_FALSE(Says(playable, "sound")) << "one sentence stands for all that is new";
}

TEST(PlayableTour, ADamagedOneIsAnErrorWithItsPath) {
  const auto reason = [](const std::function<void(Json&)>& change) -> std::string { return ErrorOf<base::Refused>([&] { Play(change); }); };
  EXPECT_TRUE(reason([](Json& json) { json["stops"][1].erase("pose"); }).starts_with("stops[1].pose "));
  EXPECT_TRUE(reason([](Json& json) { json["stops"][0]["link"]["url"] = "javascript:x"; }).starts_with("stops[0].link.url "));
  EXPECT_TRUE(reason([](Json& json) { json["version"] = "new"; }).starts_with("version "));
  EXPECT_TRUE(reason([](Json& json) { json["things"][3]["asset"] = "../x.glb"; }).starts_with("things[3].asset "));
  EXPECT_THROW(ReadTourToPlay("{", [](const std::string&, uint64_t) { return true; }), base::Refused);
}

}  // namespace
}  // namespace skyquilt::tour
