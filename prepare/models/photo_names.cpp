#include "prepare/models/photo_names.h"

#include <algorithm>
#include <filesystem>

#include "core/base/text.h"

namespace skyquilt::prepare {

namespace fs = std::filesystem;

PhotoNames::PhotoNames(const std::vector<std::string>& names) {
  for (size_t i = 0; i < names.size(); ++i) {
    if (!by_path_.emplace(names[i], i).second) continue;
    const fs::path path(names[i]);
    by_file_name_[base::LowerCase(path.filename().string())].push_back(i);
    by_stem_[base::LowerCase(path.stem().string())].push_back(i);
  }
}

std::string PhotoNames::Cleaned(std::string label) {
  std::replace(label.begin(), label.end(), '\\', '/');
  return fs::path(label).lexically_normal().generic_string();
}

std::optional<size_t> PhotoNames::FindPath(const std::string& path) const {
  const auto same = by_path_.find(path);
  return same == by_path_.end() ? std::nullopt : std::optional(same->second);
}

std::optional<size_t> PhotoNames::FindFileName(const std::string& label) const {
  const std::string name = base::LowerCase(fs::path(Cleaned(label)).filename().string());
  auto same = by_file_name_.find(name);
  if (same == by_file_name_.end()) {
    same = by_stem_.find(name);
    if (same == by_stem_.end()) return std::nullopt;
  }
  return same->second.size() == 1 ? std::optional(same->second.front()) : std::nullopt;
}

std::optional<size_t> PhotoNames::Find(const std::string& label) const {
  const std::optional<size_t> exact = FindPath(label);
  return exact ? exact : FindFileName(label);
}

}  // namespace skyquilt::prepare
