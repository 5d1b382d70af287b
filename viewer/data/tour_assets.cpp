#include "viewer/data/tour_assets.h"

#include <chrono>
#include <optional>
#include <span>
#include <system_error>

#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/memory_map.h"
#include "core/base/sha256.h"
#include "tour/format/asset_check.h"
#include "tour/format/asset_name.h"
#include "tour/format/tour_file.h"
#include "viewer/data/data_replies.h"

namespace skyquilt::viewer {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "tour/assets/";
constexpr const char* kWhat = "the file";
// Longer than any file of 50 MiB takes to be written.
constexpr std::chrono::hours kLeftOver{1};

std::optional<tour::AssetName> NameIn(const std::string& path) {
  return tour::ParseAssetName(std::string_view(path).substr(kPrefix.size()));
}

bool IsFile(const fs::path& file) {
  std::error_code error;
  return fs::symlink_status(file, error).type() == fs::file_type::regular;
}

// Whether these bytes are stored already. What a fault of the disk has changed is stored again.
bool IsStored(const fs::path& file, const std::string& digest, size_t bytes) {
  std::error_code error;
  if (!IsFile(file) || fs::file_size(file, error) != bytes || error) return false;
  try {
    return base::Sha256Hex(base::MemoryMap(file).bytes()) == digest;
  } catch (const base::InputError&) {
    return false;
  }
}

// Bytes of all files in the folder. Removes what killed programs have left half written.
uint64_t TidyFolder(const fs::path& folder) {
  uint64_t bytes = 0;
  std::error_code error;
  const auto now = fs::file_time_type::clock::now();
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    if (!IsFile(entry->path())) continue;
    const std::string name = entry->path().filename().string();
    const bool half = name.starts_with(".") && name.find(".tmp.") != std::string::npos;
    if (half && now - fs::last_write_time(entry->path(), ignored) > kLeftOver && fs::remove(entry->path(), ignored)) continue;
    const uint64_t size = fs::file_size(entry->path(), ignored);
    if (!ignored) bytes += size;
  }
  return bytes;
}

void CreateFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) base::ThrowFileError(folder, "cannot create the folder", error.value());
}

}  // namespace

bool IsAssetPath(const std::string& path) {
  return path.starts_with(kPrefix);
}

DataReply GetAsset(const fs::path& project_folder, const std::string& path) {
  const auto name = NameIn(path);
  if (!name) return DataReply::NotFound("there is no such file of the tour");
  const fs::path file = tour::AssetFolder(project_folder) / name->File();
  if (!IsFile(file)) return DataReply::NotFound("this file of the tour is missing in tour/assets of the project folder");
  return {.status = 200, .content_type = tour::ContentType(name->type), .body = "", .file = file, .cache = true};
}

DataReply PutAsset(const fs::path& project_folder, const std::string& path, const std::string& body, uint64_t max_folder_bytes) {
  const auto name = NameIn(path);
  if (!name) return TextReply(400, "a file of the tour is named by the 64 hexadecimal digits of its SHA-256, and .glb, .png or .jpg");
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(body.data()), body.size());
  if (base::Sha256Hex(bytes) != name->digest) {
    return TextReply(415, "the file is not saved: its content was changed on its way, because it has another digest than its name. Upload it again");
  }
  try {
    tour::CheckAsset(name->type, bytes);
    const fs::path folder = tour::AssetFolder(project_folder), file = folder / name->File();
    if (IsStored(file, name->digest, body.size())) return TextReply(204, "");
    CreateFolder(folder);
    if (TidyFolder(folder) + body.size() > max_folder_bytes) {
      return TextReply(413, "the file is not saved: the files of the tour would take more than " + std::to_string(max_folder_bytes >> 20U) +
                                " MiB. Remove those that it does not use from tour/assets of the project folder");
    }
    base::WriteFileAtomically(file, body);
    return TextReply(204, "");
  } catch (const base::Refused& refused) {
    return TextReply(415, std::string("the file is not saved: ") + refused.what());
  } catch (const base::InputError& failure) {
    return FailureReply(failure, kWhat);
  }
}

}  // namespace skyquilt::viewer
