// The models and pictures of a tour, in tour/assets/ of the project folder under the digests of their contents.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "viewer/server/server.h"

namespace skyquilt::viewer {

constexpr uint64_t kMaxAssetFolderBytes = 1ULL << 30U;

// Whether a path below /data/ is that of an asset, good or bad: "tour/assets/...".
bool IsAssetPath(const std::string& path);

// The file of this name; 404 when there is none, or the name is not that of an asset.
DataReply GetAsset(const std::filesystem::path& project_folder, const std::string& path);

// Stores the file: it is there whole, or not at all. 204, also when it is there already, or with the reason as text: 400 (no such name), 415 (not the
// digest or the type of its name), 413 (the folder would become larger than max_folder_bytes), 409 (no permission), 507 (disk full), 500.
DataReply PutAsset(const std::filesystem::path& project_folder, const std::string& path, const std::string& body,
                   uint64_t max_folder_bytes = kMaxAssetFolderBytes);

}  // namespace skyquilt::viewer
