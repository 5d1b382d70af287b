// Reads an array of a training's state back into a buffer that has its size already.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/errors.h"

namespace skyquilt::checkpoint {

// Copies `from`, the array `name` of the file, to `to`, whose buffer stays, as tables are on huge pages. needed_by: "survey" or "configuration", what
// gave `to` its size. Throws base::InputError when the sizes differ.
template <typename T>
void TakeArray(const std::vector<T>& from, const std::string& name, const std::filesystem::path& file, const std::string& needed_by,
               std::vector<T>& to) {
  if (from.size() != to.size()) {
    throw base::InputError(
        file, "array '" + name + "' has " + std::to_string(from.size()) + " numbers, but this " + needed_by + " needs " + std::to_string(to.size()),
        "Train again with --restart");
  }
  std::copy(from.begin(), from.end(), to.begin());
}

}  // namespace skyquilt::checkpoint
