#include "surface/files/earlier_files.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "core/base/file.h"

namespace skyquilt::surface {
namespace {

constexpr std::string_view kPartial = ".partial";

// Whether a name is `first`, digits and signs, `last`: mesh_0_3_-2.jpg, cloud_2.las.
bool IsNumbered(std::string_view name, std::string_view first, std::string_view last) {
  if (name.size() <= first.size() + last.size() || !name.starts_with(first) || !name.ends_with(last)) return false;
  const std::string_view number = name.substr(first.size(), name.size() - first.size() - last.size());
  return number.find_first_not_of("0123456789_-") == std::string_view::npos;
}

bool IsSurfaceFile(std::string_view name) {
  constexpr std::array<std::string_view, 9> kNames = {"mesh.glb",  "mesh.obj", "mesh.mtl",   "mesh.ply",         "cloud.las",
                                                      "cloud.ply", "tiles",    "offset.txt", "georeference.json"};
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end() || IsNumbered(name, "mesh_", ".jpg") || IsNumbered(name, "cloud_", ".las");
}

bool IsPartialFile(std::string_view name) {
  if (!name.ends_with(kPartial)) return false;
  const std::string_view target = name.substr(0, name.size() - kPartial.size());
  return IsSurfaceFile(target) || target == "mesh.glb.bin" || target == "mesh.ply.faces";
}

template <typename Rule>
void RemoveIf(const std::filesystem::path& folder, const Rule& rule) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (rule(entry->path().filename().string())) files.push_back(entry->path());
  }
  if (error) base::ThrowFileError(folder, "cannot be read", error.value());
  for (const std::filesystem::path& file : files) {
    std::filesystem::remove_all(file, error);
    if (error) base::ThrowFileError(file, "is of an earlier call and cannot be removed", error.value());
  }
}

}  // namespace

void RemovePartialFiles(const std::filesystem::path& folder) {
  RemoveIf(folder, IsPartialFile);
}

void RemoveEarlierFiles(const std::filesystem::path& folder) {
  RemoveIf(folder, IsSurfaceFile);
}

}  // namespace skyquilt::surface
