// Small operations on text.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace skyquilt::base {

// Of ASCII letters; other bytes stay, in the C locale.
inline std::string LowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// For messages. "a, b, c": `between` is put between neighbouring words. Empty for an empty list.
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
