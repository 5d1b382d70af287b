// Joins a list of words into one text, for messages.
#pragma once

#include <string>

namespace skyquilt::base {

// "a, b, c": `between` is put between neighbouring words. Empty for an empty list.
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
