// Takes chosen frames out of a video at full size.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/survey/exif.h"
#include "prepare/video/probe.h"

namespace skyquilt::prepare::video {

struct FrameToWrite {
  std::string name;          // of its file
  double file_time_s = 0.0;  // since the beginning of the video file
  survey::PhotoTags tags;
};

// Writes those that are not in the folder yet, as JPEG with their tags; each file is complete or missing. `frames` are in order of time. size: as
// VideoOptions::size. Returns the names of those that the video does not give. Throws base::InputError when a file cannot be written,
// base::Interrupted.
std::set<std::string> WriteFrames(const std::filesystem::path& video, const VideoInfo& info, bool interlaced, int size,
                                  const std::vector<FrameToWrite>& frames, const std::filesystem::path& folder);

}  // namespace skyquilt::prepare::video
