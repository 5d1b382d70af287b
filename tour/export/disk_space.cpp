#include "tour/export/disk_space.h"

#include <fmt/core.h>

#include <system_error>

#include "core/base/errors.h"

namespace skyquilt::tour {

namespace fs = std::filesystem;

std::string MegabytesText(int64_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

void RequireFreeSpace(const fs::path& folder, int64_t bytes, const std::string& what) {
  std::error_code error;
  fs::path there = fs::absolute(folder, error);
  while (!there.empty() && !fs::exists(there, error) && there != there.parent_path()) there = there.parent_path();
  const fs::space_info space = fs::space(there, error);
  if (error || space.available == static_cast<std::uintmax_t>(-1) || space.available >= static_cast<std::uintmax_t>(bytes)) return;
  throw base::InputError(
      folder,
      fmt::format("{} needs {}, but the disk has only {} free", what, MegabytesText(bytes), MegabytesText(static_cast<int64_t>(space.available))),
      "Free some space, or give another folder or a smaller size");
}

}  // namespace skyquilt::tour
