#include "coordinator/stages/photo_inputs.h"

#include <algorithm>

#include "prepare/input/zones.h"
#include "prepare/video/find_videos.h"

namespace skyquilt::coordinator {
std::vector<std::filesystem::path> ZonesAmong(const std::vector<std::string>& photos) {
  std::vector<std::filesystem::path> zones(photos.begin(), photos.end());
  const bool folders = std::all_of(zones.begin(), zones.end(), [](const auto& zone) { return std::filesystem::is_directory(zone); });
  if (!folders || zones.size() < 2) zones.clear();
  return zones;
}

std::vector<std::filesystem::path> VideosAmong(const std::vector<std::string>& photos) {
  const std::vector<std::filesystem::path> inputs(photos.begin(), photos.end());
  // What a folder holds is looked at when it is read.
  if (inputs.size() == 1 && std::filesystem::is_directory(inputs.front())) return {};
  if (!ZonesAmong(photos).empty()) return {};
  return inputs.empty() ? inputs : prepare::video::FindVideos(inputs);
}

std::filesystem::path PhotoFolderOf(const std::vector<std::string>& photos, const Project& project) {
  const std::vector<std::filesystem::path> zones = ZonesAmong(photos);
  if (!zones.empty()) return prepare::input::LinkZones(zones, project.ZonesFolder());
  return photos.empty() ? std::filesystem::path() : std::filesystem::path(photos.front());
}

}  // namespace skyquilt::coordinator
