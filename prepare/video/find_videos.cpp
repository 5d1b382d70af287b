#include "prepare/video/find_videos.h"

#include <algorithm>
#include <array>
#include <chrono>

#include "core/base/errors.h"
#include "core/base/text.h"
#include "core/image/develop.h"
#include "prepare/input/file_names.h"
#include "prepare/input/list_files.h"
#include "prepare/input/walk_folder.h"
#include "prepare/video/find_tracks.h"

namespace skyquilt::prepare::video {
namespace {

namespace fs = std::filesystem;

bool IsFilm(const fs::path& file) {
  static constexpr std::array kNoFilms = {".lrv", ".lrf", ".insv", ".360"};
  const std::string extension = base::LowerCase(file.extension().string());
  return input::GroupOf(file.filename().string()) == input::FileGroup::kVideo &&
         std::find(kNoFilms.begin(), kNoFilms.end(), extension) == kNoFilms.end();
}

std::vector<fs::path> VideosOfFolder(const fs::path& folder) {
  std::vector<fs::path> videos;
  for (const input::FoundFile& file : input::WalkFolder(folder, {}, {})) {
    const bool own = file.in == input::FoundIn::kPlainFolder || file.in == input::FoundIn::kProjectImages;
    if (!own || input::IsHiddenName(fs::path(file.name).filename().string())) continue;
    if (input::LooksLikePhoto(file.name) || image::NeedsDeveloping(file.name)) return {};
    if (IsFilm(file.name)) videos.push_back(folder / file.name);
  }
  return videos;
}

}  // namespace

std::vector<fs::path> FindVideos(const std::vector<fs::path>& inputs) {
  if (inputs.size() == 1 && fs::is_directory(inputs.front())) return VideosOfFolder(inputs.front());
  std::vector<fs::path> videos;
  for (const fs::path& given : inputs) {
    if (!fs::exists(given)) throw base::InputError(given, "no such folder or file", "Give folders that hold the photos, or video files");
  }
  for (const fs::path& given : inputs) {
    if (fs::is_directory(given)) {
      throw base::UsageError("give folders of photos, or video files, not both: " + given.string() + " is a folder");
    }
    if (!IsFilm(given)) throw base::InputError(given, "is no video", "Give the folder that holds the photos, or video files such as DJI_0001.MP4");
    videos.push_back(fs::absolute(given).lexically_normal());
  }
  return videos;
}

std::string VideosIdentity(const std::vector<fs::path>& videos) {
  std::string text;
  const auto add = [&text](const fs::path& file) {
    std::error_code error;
    const auto size = fs::file_size(file, error);
    if (error) return;
    const auto time = std::chrono::duration_cast<std::chrono::seconds>(fs::last_write_time(file, error).time_since_epoch()).count();
    text += file.string() + "|" + std::to_string(size) + "|" + std::to_string(time) + "\n";
  };
  for (const fs::path& video : videos) {
    add(video);
    for (const fs::path& file : FilesBeside(video)) add(file);
  }
  return text;
}

}  // namespace skyquilt::prepare::video
