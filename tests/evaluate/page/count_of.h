// What tests of pages count: parts of a text, and tags that are opened and closed.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace skyquilt::evaluate::page {

inline size_t CountOf(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

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
