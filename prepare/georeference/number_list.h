// Numbers in the text of an option.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::georeference {

// The parts between the separators, without spaces around them; one empty part for an empty text.
inline std::vector<std::string> SplitOption(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const size_t first = part.find_first_not_of(" \t"), last = part.find_last_not_of(" \t");
    parts.push_back(first == std::string::npos ? "" : part.substr(first, last - first + 1));
    begin = end + 1;
  }
  return parts;
}

// Three numbers; nothing when they are no numbers, or not three.
inline std::optional<Eigen::Vector3d> ParseVector(const std::string& text, char separator) {
  const std::vector<std::string> parts = SplitOption(text, separator);
  if (parts.size() != 3) return std::nullopt;
  Eigen::Vector3d vector;
  for (size_t axis = 0; axis < 3; ++axis) {
    const std::optional<double> number = tables::ParseTableNumber(parts[axis], false);
    if (!number) return std::nullopt;
    vector[static_cast<Eigen::Index>(axis)] = *number;
  }
  return vector;
}

}  // namespace skyquilt::prepare::georeference
