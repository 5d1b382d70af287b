// What the program ffprobe says of a video file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace skyquilt::prepare::video {

struct VideoInfo {
  int width = 0, height = 0;              // pixels of the frames as they are shown: upright, pixels square
  int rotation_deg = 0;                   // by which the stored frames are turned for that: 0, 90, 180 or 270
  std::optional<double> duration_s;       // as the file says; what it holds may be less
  double frames_per_s = 0.0;              // mean; 0: not known
  bool interlaced = false;                //
  bool has_subtitles = false;             // in the file
  bool has_index = true;                  // so that decoding can begin anywhere, at times that stay the same; transport streams have none
  std::optional<double> created_clock_s;  // when the recording began by the camera's clock, seconds since 1970
  std::string codec;
};

// Throws base::InputError with how to fix it when ffmpeg or ffprobe is missing, or the file holds no video that they read. Throws base::Interrupted.
VideoInfo Probe(const std::filesystem::path& file);

// Reads the JSON that ffprobe writes. Throws base::InputError that names `file`.
VideoInfo ParseProbe(const std::string& json, const std::filesystem::path& file);

}  // namespace skyquilt::prepare::video
