// How often a text has a part.
#pragma once

#include <cstddef>
#include <string>

namespace skyquilt {

inline size_t CountOf(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

}  // namespace skyquilt
