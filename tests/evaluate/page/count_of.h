// What tests of pages count: tags that are opened and closed.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/support/count_of.h"

namespace skyquilt::evaluate::page {

// Every tag that is opened is closed, and no number is NaN or infinite.
inline void ExpectBalanced(const std::string& html) {
  for (const char* tag :
       {"section", "table", "tbody", "tr", "td", "svg", "figure", "figcaption", "details", "div", "span", "g", "p", "ul", "li", "h3", "b"}) {
    const std::string name(tag);
    EXPECT_EQ(CountOf(html, "<" + name + " ") + CountOf(html, "<" + name + ">"), CountOf(html, "</" + name + ">")) << name;
  }
  EXPECT_EQ(CountOf(html, "nan") + CountOf(html, "inf\"") + CountOf(html, ">inf"), 0U);
}

}  // namespace skyquilt::evaluate::page
