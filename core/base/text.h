// Small texts from lists.
#pragma once

#include <string>

namespace skyquilt::base {

// The words one after the other, `between` two of them.
template <typename Words>
std::string Join(const Words& words, const std::string& between = ", ") {
  std::string text;
  bool first = true;
  for (const auto& word : words) {
    if (!first) text += between;
    text += word;
    first = false;
  }
  return text;
}

}  // namespace skyquilt::base
