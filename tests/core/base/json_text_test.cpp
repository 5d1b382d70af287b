#include "core/base/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace skyquilt::base {
namespace {

TEST(JsonText, IsReadBack) {
  const nlohmann::json value = {{"b", {1, 2.5, nullptr}}, {"a", "text \"quoted\""}};
  EXPECT_EQ(ParseJson(JsonText(value)), value);
  EXPECT_EQ(ParseJson(JsonText(value, 2)), value);
  EXPECT_EQ(TryParseJson(JsonText(value)), value);
  EXPECT_EQ(JsonText(nlohmann::json{{"a", 1}}), "{\"a\":1}");
  EXPECT_EQ(JsonText(nlohmann::json{{"a", 1}}, 1), "{\n \"a\": 1\n}");
}

TEST(JsonText, KeepsAnOrderThatMatters) {
  const std::string text = R"({"b":1,"a":2})";
  EXPECT_EQ(JsonText(ParseOrderedJson(text)), text);
  EXPECT_EQ(JsonText(ParseJson(text)), R"({"a":2,"b":1})");
}

TEST(JsonText, ReplacesWhatIsNotUtf8) {
  EXPECT_EQ(JsonText(nlohmann::json("a\xFFz")), "\"a\xEF\xBF\xBDz\"");
  EXPECT_EQ(JsonText(nlohmann::ordered_json("a\xFFz")), "\"a\xEF\xBF\xBDz\"");
}

TEST(JsonText, SaysWhatIsNotJson) {
  EXPECT_THROW(ParseJson("{\"a\":"), nlohmann::json::parse_error);
  EXPECT_THROW(ParseOrderedJson("{\"a\":"), nlohmann::json::parse_error);
  EXPECT_TRUE(TryParseJson("{\"a\":").is_discarded());
}

}  // namespace
}  // namespace skyquilt::base
