#include "core/base/pattern.h"

#include <gtest/gtest.h>

namespace skyquilt::base {
namespace {

TEST(Pattern, MatchesAWholeText) {
  EXPECT_EQ(MatchWhole("ab12", "([a-z]+)(\\d+)(x?)"), (PatternMatch{"ab12", "ab", "12", ""}));
  EXPECT_FALSE(MatchWhole("ab12 ", "([a-z]+)(\\d+)"));
  EXPECT_FALSE(MatchWhole("AB12", "([a-z]+)(\\d+)"));
  EXPECT_TRUE(MatchWhole("AB12", "([a-z]+)(\\d+)", true));
}

TEST(Pattern, FindsEveryPlace) {
  EXPECT_EQ(FindAll("x=1, y=22", "(\\w)=(\\d+)"), (std::vector<PatternMatch>{{"x=1", "x", "1"}, {"y=22", "y", "22"}}));
  EXPECT_TRUE(FindAll("nothing", "\\d").empty());
}

}  // namespace
}  // namespace skyquilt::base
