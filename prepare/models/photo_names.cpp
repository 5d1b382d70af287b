#include "prepare/models/photo_names.h"

#include <algorithm>
#include <filesystem>

#include "core/base/text.h"

namespace skyquilt::prepare::models {

namespace fs = std::filesystem;

namespace {

std::string Unquoted(const std::string& label) {
  const size_t begin = label.find_first_not_of(" \t\"'");
  return begin == std::string::npos ? "" : label.substr(begin, label.find_last_not_of(" \t\"'") - begin + 1);
}

}  // namespace

PhotoNames::PhotoNames(const std::vector<std::string>& names) : names_(names) {
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
  if (const std::optional<size_t> exact = FindPath(label)) return exact;
  const std::string name = Unquoted(label);
  if (const std::optional<size_t> exact = FindPath(Cleaned(name))) return exact;
  if (const std::optional<size_t> only = FindFileName(name)) return only;
  const auto same = by_file_name_.find(base::LowerCase(fs::path(Cleaned(name)).filename().string()));
  if (same == by_file_name_.end()) return std::nullopt;
  std::optional<size_t> best;
  size_t most = 1;
  for (const size_t i : same->second) {
    const size_t parts = CommonParts(name, i);
    if (parts < most) continue;
    best = parts > most ? std::optional(i) : std::nullopt;
    most = parts;
  }
  return best;
}

size_t PhotoNames::CommonParts(const std::string& label, size_t index) const {
  const fs::path a(base::LowerCase(Cleaned(label))), b(base::LowerCase(names_.at(index)));
  size_t n = 0;
  auto x = a.end(), y = b.end();
  while (x != a.begin() && y != b.begin() && *--x == *--y) ++n;
  return n;
}

}  // namespace skyquilt::prepare::models
