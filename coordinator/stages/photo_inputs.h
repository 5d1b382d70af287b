// What `prepare` and `run` get as photos: a folder of photos or of videos, several folders of photos, or video files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/project/project.h"

namespace skyquilt::coordinator {

// These when they are several folders, else none.
std::vector<std::filesystem::path> ZonesAmong(const std::vector<std::string>& photos);
// Videos among these, for Pipeline::videos; empty for folders. Throws base::InputError when nothing is there, base::UsageError for a folder beside
// videos.
std::vector<std::filesystem::path> VideosAmong(const std::vector<std::string>& photos);
// The folder of the photos; of several folders one with links to them, in the project (prepare/input/zones.h), with its errors. Not used for videos.
std::filesystem::path PhotoFolderOf(const std::vector<std::string>& photos, const Project& project);

}  // namespace skyquilt::coordinator
