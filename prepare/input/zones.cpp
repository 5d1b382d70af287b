#include "prepare/input/zones.h"

#include <algorithm>
#include <map>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

bool IsInside(const fs::path& inner, const fs::path& outer) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

std::vector<fs::path> Resolved(const std::vector<fs::path>& zones, const fs::path& links) {
  std::vector<fs::path> resolved;
  for (const fs::path& zone : zones) {
    if (!fs::is_directory(zone)) throw base::InputError(zone, "no such folder", "Give the folders that hold the photos of the zones");
    resolved.push_back(fs::canonical(zone));
    // Of a simulated survey only the photos: its poses are those of one zone.
    if (fs::exists(resolved.back() / "simulate.json") && fs::is_directory(resolved.back() / "images")) resolved.back() /= "images";
  }
  for (size_t i = 0; i < zones.size(); ++i) {
    if (IsInside(fs::weakly_canonical(links), resolved[i])) {
      throw base::UsageError("the project folder is inside the photos of " + zones[i].string() + ": give another one (-o)");
    }
    for (size_t k = 0; k < zones.size(); ++k) {
      if (i == k || !IsInside(resolved[i], resolved[k])) continue;
      const bool same = resolved[i] == resolved[k];
      throw base::UsageError("the folder " + zones[i].string() + (same ? " is given twice" : " is inside " + zones[k].string()) +
                             ": its photos would count twice");
    }
  }
  return resolved;
}

std::string LongName(const fs::path& zone) {
  return zone.parent_path().filename().string() + "_" + zone.filename().string();
}

// Makes the folder hold these links and nothing else.
void WriteLinks(const std::map<std::string, fs::path>& links, const fs::path& folder) {
  fs::create_directories(folder);
  base::RequireWritableFolder(folder);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const auto link = links.find(entry.path().filename().string());
    std::error_code ignored;
    if (link == links.end() || !fs::equivalent(entry.path(), link->second, ignored)) fs::remove(entry.path());
  }
  std::string names;
  for (const auto& [name, zone] : links) {
    if (!fs::exists(fs::symlink_status(folder / name))) fs::create_directory_symlink(zone, folder / name);
    names += (names.empty() ? "" : ", ") + name;
  }
  base::LogInfo("photos of {} zones: {}", links.size(), names);
}

}  // namespace

fs::path LinkZones(const std::vector<fs::path>& zones, const fs::path& folder) {
  const std::vector<fs::path> resolved = Resolved(zones, folder);
  std::map<std::string, size_t> n_of_name;
  for (const fs::path& zone : resolved) ++n_of_name[zone.filename().string()];
  std::map<std::string, fs::path> links;
  for (const fs::path& zone : resolved) {
    const std::string own = zone.filename().string();
    const std::string name = n_of_name.at(own) > 1 ? LongName(zone) : own;
    if (!links.emplace(name, zone).second) {
      throw base::UsageError("the folders " + links.at(name).string() + " and " + zone.string() + " have one name: rename one of them");
    }
  }
  WriteLinks(links, folder);
  return folder;
}

fs::path AddZones(const fs::path& earlier, const std::vector<fs::path>& zones, const fs::path& folder) {
  std::map<std::string, fs::path> links;
  std::vector<fs::path> all;
  if (fs::weakly_canonical(earlier) == fs::weakly_canonical(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      links.emplace(entry.path().filename().string(), fs::canonical(entry.path()));
      all.push_back(links.at(entry.path().filename().string()));
    }
  } else {
    all.push_back(earlier);
  }
  const size_t n_linked = links.size();
  for (const fs::path& zone : zones) {
    const auto same = [&](const fs::path& other) {
      std::error_code ignored;
      return fs::equivalent(zone, other, ignored) || fs::equivalent(zone / "images", other, ignored);
    };
    if (std::none_of(all.begin(), all.end(), same)) all.push_back(zone);
  }
  if (all.size() == 1) return earlier;
  if (n_linked == 0) return LinkZones(all, folder);
  const std::vector<fs::path> resolved = Resolved(all, folder);
  for (size_t i = n_linked; i < resolved.size(); ++i) {
    const std::string own = resolved[i].filename().string();
    if (links.emplace(own, resolved[i]).second || links.emplace(LongName(resolved[i]), resolved[i]).second) continue;
    throw base::UsageError("the folders " + links.at(own).string() + " and " + resolved[i].string() + " have one name: rename one of them");
  }
  WriteLinks(links, folder);
  return folder;
}

}  // namespace skyquilt::prepare::input
