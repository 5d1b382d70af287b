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

TEST(LowerCase, ChangesLettersOnly) {
  EXPECT_EQ(LowerCase("IMG_01.JpG"), "img_01.jpg");
  // Bytes of other alphabets stay as they are.
  EXPECT_EQ(LowerCase("\xC3\x84Z"), "\xC3\x84z");
}

}  // namespace
}  // namespace skyquilt::base
