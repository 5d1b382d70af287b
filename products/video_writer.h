// MP4 from frames. H.264 through the ffmpeg program when it is installed, otherwise MPEG-4 through OpenCV.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/image/image.h"

namespace skyquilt::products {

class VideoWriter {
 public:
  // Width and height even, fps > 0 (std::logic_error). `ffmpeg` is the program to run; a path that does not exist leads to OpenCV.
  // Throws base::InputError when neither can write the file. Nothing is at `file` until Close.
  VideoWriter(const std::filesystem::path& file, int width, int height, int fps, const std::string& ffmpeg = "ffmpeg");
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  // RGB, of the size named above.
  void Write(const image::Image8& frame);
  void Close();
  const std::string& encoder() const;  // "ffmpeg libx264" or "OpenCV mp4v"

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::products
