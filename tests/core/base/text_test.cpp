#include "core/base/text.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace skyquilt::base {
namespace {

TEST(Join, PutsTheSeparatorBetweenWords) {
  EXPECT_EQ(Join(std::vector<std::string>{}), "");
  EXPECT_EQ(Join(std::vector<std::string>{"one"}), "one");
  EXPECT_EQ(Join(std::vector<std::string>{"", "two", ""}), ", two, ");
  EXPECT_EQ(Join(std::set<std::string>{"b", "a"}, "; "), "a; b");
}

}  // namespace
}  // namespace skyquilt::base
