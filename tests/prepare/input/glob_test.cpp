#include "prepare/input/glob.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/error_of.h"

namespace skyquilt::prepare::input {
namespace {

TEST(MatchesPattern, ComparesNamesOrPaths) {
  EXPECT_TRUE(MatchesPattern("*.JPG", "flight1/DJI_0001.jpg"));
  EXPECT_TRUE(MatchesPattern("DJI_000?.jpg", "a/b/DJI_0001.JPG"));
  EXPECT_FALSE(MatchesPattern("DJI_000?.jpg", "DJI_0010.JPG"));
  EXPECT_FALSE(MatchesPattern("dji_*.jpg", "DJI_0001.JPG")) << "upper and lower case differ before the extension";
  EXPECT_TRUE(MatchesPattern("flight1/*", "flight1/a.jpg"));
  EXPECT_FALSE(MatchesPattern("flight1/*", "flight1/sub/a.jpg"));
  EXPECT_TRUE(MatchesPattern("flight1/**", "flight1/sub/a.jpg"));
  EXPECT_TRUE(MatchesPattern("**/a.jpg", "flight1/sub/a.jpg"));
  EXPECT_FALSE(MatchesPattern("flight1/*", "flight10/a.jpg"));
  EXPECT_TRUE(MatchesPattern("v1.2/*.jpg", "v1.2/a.jpg"));
  EXPECT_TRUE(MatchesPattern("*", "a.jpg"));
  EXPECT_FALSE(MatchesPattern("", "a.jpg"));
}

TEST(MatchesPattern, TakesNoExponentialTime) {
  std::string pattern;
  for (int i = 0; i < 40; ++i) pattern += "*a";
  EXPECT_FALSE(MatchesPattern(pattern + "b", std::string(200, 'a')));
}

TEST(ParsePatterns, SplitsAtCommas) {
  EXPECT_EQ(ParsePatterns(" *.JPG , ./flight 1/*,,"), (std::vector<std::string>{"*.JPG", "flight 1/*"}));
  EXPECT_NE(UsageErrorOf([] { ParsePatterns(","); }).find("has no pattern"), std::string::npos);
}

RC_GTEST_PROP(MatchesPattern, EveryNameMatchesItselfAndItsPartsWithStars, ()) {
  // A star takes no '/', and what follows the last '.' is compared in another way.
  const auto name = *rc::gen::container<std::string>(rc::gen::elementOf(std::string("abAB0_- ")));
  const auto at = static_cast<size_t>(*rc::gen::inRange(0, static_cast<int>(name.size()) + 1));
  RC_ASSERT(MatchesPattern(name, name));
  RC_ASSERT(MatchesPattern(name.substr(0, at) + "*", name));
  RC_ASSERT(MatchesPattern("*" + name.substr(at), name));
  RC_ASSERT(MatchesPattern(name, "folder/" + name));
  RC_ASSERT(!MatchesPattern(name + "x", name));
}

}  // namespace
}  // namespace skyquilt::prepare::input
