// How a file looks from outside, to notice that it was replaced.
#pragma once

#include <cstdint>
#include <filesystem>

namespace skyquilt::viewer {

struct FileLook {
  bool exists = false;
  uint64_t device = 0, inode = 0;
  int64_t bytes = 0;
  int64_t modified_ns = 0;

  bool operator==(const FileLook&) const = default;
};

// A file that cannot be looked at counts as missing.
FileLook LookAt(const std::filesystem::path& file);

}  // namespace skyquilt::viewer
