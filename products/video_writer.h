// Writes frames to an MP4 file: as H.264 by the ffmpeg program if it is installed, otherwise as MPEG-4 by OpenCV.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/image/image.h"

namespace skyquilt::products {

class VideoWriter {
 public:
  // `ffmpeg`: the program to run; if it does not exist, OpenCV is used. Until Close nothing is written to `file` itself, only to a file beside it.
  // Throws std::logic_error unless width and height are even and fps > 0, base::InputError when neither program can write the file.
  VideoWriter(const std::filesystem::path& file, int width, int height, int fps, const std::string& ffmpeg = "ffmpeg");
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  // Adds a frame: RGB, width x height. Throws base::InputError when ffmpeg fails.
  void Write(const image::Image8& frame);
  void Close();
  const std::string& encoder() const;  // "ffmpeg libx264" or "OpenCV mp4v"

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::products
