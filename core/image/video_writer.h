// Writes frames to an MP4 file (H.264) by the program ffmpeg.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/image/image.h"

namespace skyquilt::image {

// Whether ffmpeg is installed.
bool CanWriteVideos();

class VideoWriter {
 public:
  // `ffmpeg`: the program to run. Until Close nothing is written to `file` itself, only to a file beside it.
  // Throws std::logic_error unless width and height are even and fps > 0, base::InputError when the program is missing or cannot be started.
  VideoWriter(const std::filesystem::path& file, int width, int height, int fps, const std::string& ffmpeg = "ffmpeg");
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  // Adds a frame: RGB, width x height. Throws base::InputError when ffmpeg fails.
  void Write(const Image8& frame);
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::image
