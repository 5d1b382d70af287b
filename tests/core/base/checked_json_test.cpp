#include "core/base/checked_json.h"

#include <gtest/gtest.h>

#include <limits>
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

TEST(CheckedJson, NamesThePlace) {
  const auto reason = [](const auto& check) -> std::string {
    try {
      check();
    } catch (const Refused& refused) {
      return refused.what();
    }
    return "";
  };
  EXPECT_TRUE(reason([] { RequireNumber("1", "a[3].b"); }).starts_with("a[3].b must be a number"));
  EXPECT_TRUE(reason([] { RequireNumber(std::numeric_limits<double>::quiet_NaN(), "a"); }).starts_with("a must be a number"));
  EXPECT_TRUE(reason([] { RequireNumber(1.1e9, "a"); }).starts_with("a must be a number"));
  EXPECT_EQ(reason([] { RequireNumber(-1e9, "a"); }), "");
  EXPECT_EQ(reason([] { RequireLine("two\nlines", 80, "a.title"); }), "a.title must be one line");
  EXPECT_TRUE(reason([] { RequireLine("", 80, "a"); }).starts_with("a must be a text"));
  EXPECT_TRUE(reason([] { RequireLine("abc", 2, "a"); }).starts_with("a must be a text"));
  EXPECT_EQ(reason([] { RequireLine("<script>", 80, "a"); }), "");
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
