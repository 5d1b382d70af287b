#include "core/base/checked_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace skyquilt::base {
namespace {

TEST(CheckedJson, RefusesWhatIsNotJsonOrTooDeep) {
  EXPECT_EQ(ParseDocument(R"({"a": [1]})")["a"][0], 1);
  for (const std::string& text : {std::string(), std::string("{"), std::string("{} x"), std::string("\"\xff\""),
                                  std::string(33, '[') + std::string(33, ']'), std::string(1'000'000, '['), std::string("[1e999]")}) {
    EXPECT_THROW(ParseDocument(text), Refused) << text.substr(0, 40);
  }
  EXPECT_NO_THROW(ParseDocument(std::string(32, '[') + std::string(32, ']')));
  EXPECT_NO_THROW(ParseDocument("\"" + std::string(100, '[') + "\"")) << "brackets in texts are no nesting";
}

TEST(CheckedJson, RefusesRepeatedKeysWhereAsked) {
  const std::string text = R"({"a": {"b": 1, "c": {"b": 2}}, "b": [{"a": 1}, {"a": 1}]})";
  EXPECT_NO_THROW(ParseDocument(text, RepeatedKeys::kRefused)) << "of different objects";
  const std::string twice = R"({"a": [{"b": 1, "c": 2, "b": 3}]})";
  EXPECT_EQ(ParseDocument(twice)["a"][0]["b"], 3);
  EXPECT_THROW(ParseDocument(twice, RepeatedKeys::kRefused), Refused);
  EXPECT_THROW(ParseDocument("{", RepeatedKeys::kRefused), Refused);
}

TEST(CheckedJson, ShowsTheStartOfATextFromOutside) {
  EXPECT_EQ(ShownStart("seq"), "seq");
  EXPECT_EQ(ShownStart("a\n\"b\\\xC3 x"), "a??b?? x");
  EXPECT_EQ(ShownStart(std::string(41, 'x')), std::string(40, 'x') + "...");
}

TEST(CheckedJson, NumbersOfOurFilesMayBeMissing) {
  const nlohmann::json json = {{"a", 1.5}, {"b", nullptr}};
  EXPECT_EQ(NumberIn(json, "a"), 1.5);
  EXPECT_EQ(NumberIn(json, "b", 7.0), 7.0);
  EXPECT_TRUE(std::isnan(NumberIn(json, "c")) && std::isnan(NumberIn(nullptr, "a")));
}

TEST(CheckedJson, FindsTheEndOfATextWithQuotesAndBackslashesInIt) {
  const auto rest = [](const std::string& document, size_t begin = 0) { return document.substr(EndOfText(document, begin)); };
  EXPECT_EQ(rest(R"("", 1)"), ", 1");
  EXPECT_EQ(rest(R"(["a", "b"])", 1), R"(, "b"])");
  EXPECT_EQ(rest(R"("a \" ]", [)"), ", [");
  EXPECT_EQ(rest(R"("C:\\", ")"), R"(, ")") << "a backslash before the end that is itself escaped";
  EXPECT_EQ(rest(R"("\\\"x", 2)"), ", 2");
  for (const char* open : {"\"", "\"abc", "\"abc\\", "\"abc\\\""}) EXPECT_EQ(EndOfText(open, 0), std::string(open).size()) << open;
  EXPECT_NO_THROW(ParseDocument(R"("\"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[")"));
}

TEST(CheckedJson, CountsCharactersOfAnyScript) {
  EXPECT_EQ(CharactersIn(""), 0U);
  EXPECT_EQ(CharactersIn("abc"), 3U);
  EXPECT_EQ(CharactersIn("Zürich 東京 🏠"), 11U);
}

}  // namespace
}  // namespace skyquilt::base
