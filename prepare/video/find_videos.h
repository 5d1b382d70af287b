// Which videos frames are taken from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::prepare::video {

// `inputs`: one folder, or video files. Returns those files in the order given, or the videos of a folder, searched recursively, that holds no
// photos, in name order: small copies beside videos (.lrv, .lrf) and films of all directions (.insv, .360) are left out. Empty: a folder of photos,
// whose videos are left out, or of nothing of use. Throws base::InputError for files that are not there or no videos, base::UsageError for a folder
// beside others.
std::vector<std::filesystem::path> FindVideos(const std::vector<std::filesystem::path>& inputs);

// Text that changes when a video or a file beside it does: names, sizes and times; contents are not read. Those that are not there are left out.
std::string VideosIdentity(const std::vector<std::filesystem::path>& videos);

}  // namespace skyquilt::prepare::video
