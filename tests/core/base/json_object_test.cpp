#include "core/base/json_object.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/base/checked_json.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::base {
namespace {

using nlohmann::json;

std::string RefusalOf(const std::function<void()>& read) {
  return ErrorOf<Refused>([&] { read(); });
}

TEST(JsonValue, NamesThePlaceInADocument) {
  const auto number = [](const json& value) { return RefusalOf([&] { JsonValue(value, "a[3].b").Number(); }); };
  EXPECT_EQ(number("1"), "a[3].b must be a number from -1e9 to 1e9");
  EXPECT_NE(number(std::numeric_limits<double>::quiet_NaN()), "");
  EXPECT_NE(number(1.1e9), "");
  EXPECT_EQ(number(-1e9), "");
  const auto text = [](const json& value) { return RefusalOf([&] { JsonValue(value, "a.title").Text(3); }); };
  EXPECT_EQ(text("a\nb"), "a.title must be one line");
  EXPECT_EQ(text(7), "a.title must be a text");
  EXPECT_EQ(text(""), "a.title must be a text of 1 to 3 bytes");
  EXPECT_EQ(text("abcd"), "a.title must be a text of 1 to 3 bytes");
  EXPECT_EQ(text("<b>"), "");
  const json document = ParseDocument(R"({"stops": [{"title": 3}]})");
  EXPECT_EQ(RefusalOf([&] { JsonValue(document).At("stops").At(0).At("title").Text(); }), "stops[0].title must be a text");
  EXPECT_EQ(RefusalOf([] { JsonValue(json(1)).Fail("must be an object"); }), "it must be an object");
}

TEST(JsonValue, BoundsAreShownShort) {
  EXPECT_EQ(RangeText(10, 120), "from 10 to 120");
  EXPECT_EQ(RangeText(-0.5, 1.001), "from -0.5 to 1.001");
  EXPECT_EQ(RangeText(0.0001, 10000), "from 0.0001 to 10000");
  EXPECT_EQ(RangeText(-1e7, 2.5e-12), "from -1e7 to 2.5e-12");
}

TEST(JsonObject, TakesMembersAndKnowsTheRest) {
  const json document = ParseDocument(R"({"id": 7, "size": [1.5, 2], "ring": [[0, 1], [2, 3]], "base": "plane", "more": 1, "note": null})");
  JsonObject object{JsonValue(document)};
  EXPECT_EQ(object.Integer("id", 0, 10), 7);
  std::array<double, 2> size = {};
  object.Numbers("size", 10.0, size);
  EXPECT_EQ(size, (std::array<double, 2>{1.5, 2.0}));
  EXPECT_EQ(object.Pairs("ring", 1, 2, 10.0).at(1), (std::array<double, 2>{2.0, 3.0}));
  EXPECT_EQ(object.OneOf("base", {"lowest", "plane"}), 1U);
  EXPECT_FALSE(object.FindUnlessNull("note"));
  EXPECT_EQ(object.LineOrEmpty("title", 5), "");
  EXPECT_EQ(object.NumberOrZero("pause_s", 5.0), 0.0);
  EXPECT_EQ(object.Rest(), std::vector<std::string>({"more"}));
}

TEST(JsonObject, NamesTheMemberAndItsRule) {
  const json document = ParseDocument(R"({"at": {"id": 1.0, "xy": [1, 11], "flag": 1, "line": "a\u2028b", "list": [1, 2, 3]}})");
  const auto refusal = [&](const auto& read) {
    return RefusalOf([&] {
      JsonObject object{JsonValue(document)};
      JsonObject at = object.Object("at");
      read(at);
    });
  };
  std::array<double, 2> xy = {};
  EXPECT_EQ(refusal([](JsonObject& at) { at.Integer("id", 0, 10); }), "at.id must be a whole number from 0 to 10");
  EXPECT_EQ(refusal([](JsonObject& at) { at.Number("id", 2, 10); }), "at.id must be a number from 2 to 10");
  EXPECT_EQ(refusal([&](JsonObject& at) { at.Numbers("xy", 10.0, xy); }), "at.xy must be 2 numbers from -10 to 10");
  EXPECT_EQ(refusal([](JsonObject& at) { at.Flag("flag"); }), "at.flag must be true or false");
  EXPECT_EQ(refusal([](JsonObject& at) { at.Line("line", 10); }), "at.line must be one line of 1 to 10 characters");
  EXPECT_EQ(refusal([](JsonObject& at) { at.List("list", 2); }), "at.list must be a list of at most 2");
  EXPECT_EQ(refusal([](JsonObject& at) { at.Flag("gone"); }), "at.gone is missing");
  EXPECT_EQ(refusal([](JsonObject& at) { JsonObject(at.Need("id")); }), "at.id must be an object");
}

TEST(JsonObject, OfAFileNamesItsLineToo) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder.path() / "a.json", "{\n \"at\": [\n  {\"id\": true}]}");
  const std::string error = InputErrorOf([&] {
    const JsonDocument document(folder.path() / "a.json", "Write it again");
    JsonObject object(document.Root().At("at").At(0));
    object.Need("name");
  });
  EXPECT_NE(error.find("a.json: line 3: at[0].name is missing"), std::string::npos) << error;
  EXPECT_NE(error.find("Write it again"), std::string::npos) << error;
}

}  // namespace
}  // namespace skyquilt::base
