#include "tour/export/staged_folder.h"

#include <array>
#include <fstream>
#include <string_view>
#include <system_error>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::tour {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIndex = "index.html";
constexpr const char* kData = "data";
constexpr std::array<std::string_view, 8> kOurs = {kIndex, "tour.js", "tour.css", "licences.txt", "poster.jpg", "embed.html", "tour.mp4", kData};
constexpr std::string_view kManifestBegin = "skyquiltData(\"manifest.json\"";

bool HasManifest(const fs::path& folder) {
  std::ifstream stream(folder / "data" / "manifest.json.js", std::ios::binary);
  std::string begin(kManifestBegin.size(), '\0');
  return stream.read(begin.data(), static_cast<std::streamsize>(begin.size())) && begin == kManifestBegin;
}

std::vector<std::string> NamesIn(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  if (error) base::ThrowFileError(folder, "cannot be read", error.value());
  return names;
}

void Remove(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) base::ThrowFileError(path, "cannot be removed", error.value());
}

void RequireOurs(const fs::path& folder, const std::set<std::string>& expected) {
  if (HasManifest(folder)) return;
  for (const std::string& name : NamesIn(folder)) {
    if (expected.contains(name)) continue;
    throw base::InputError(folder, "is no exported tour, and there is something in it (" + name + ")",
                           "Give a new folder, or an earlier export, which is then replaced");
  }
}

}  // namespace

std::vector<std::string> ExportedNames() {
  return {kOurs.begin(), kOurs.end()};
}

StagedFolder::StagedFolder(const fs::path& folder, const std::set<std::string>& expected) : folder_(fs::absolute(folder).lexically_normal()) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  std::error_code error;
  const fs::file_status status = fs::status(folder_, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status)) throw base::InputError(folder_, "is a file", "Give a folder for the tour");
    RequireOurs(folder_, expected);
  }
  partial_.emplace(folder_);
  base::RequireWritableFolder(partial());
}

void StagedFolder::Publish() {
  base::SyncPath(partial());
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) base::ThrowFileError(folder_, "cannot be created", error.value());
  const std::vector<std::string> names = NamesIn(partial());
  const fs::path data = folder_ / kData;
  Remove(folder_ / kIndex);
  // The data say whose the folder is: they are the last to go, in one step, and the first to come.
  for (const std::string_view name : kOurs) {
    if (name != kData) Remove(folder_ / name);
  }
  if (fs::exists(fs::symlink_status(data, error))) base::Rename(data, partial() / "old");
  base::Rename(partial() / kData, data);
  for (const std::string& name : names) {
    if (name != kIndex && name != kData) base::Rename(partial() / name, folder_ / name);
  }
  base::SyncPath(folder_);
  base::Rename(partial() / kIndex, folder_ / kIndex);
  base::SyncPath(folder_);
}

}  // namespace skyquilt::tour
