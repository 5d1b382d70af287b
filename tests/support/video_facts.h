// What ffprobe and ffmpeg say of a video that a test has written.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/child_process.h"

namespace skyquilt {

struct VideoFacts {
  int frames = 0;
  int width = 0;
  int height = 0;
  std::string rate;  // frames per second, as a fraction
  std::string codec;
  std::array<int, 3> middle = {};  // of the first frame: red, green, blue
};

inline std::string OutputOf(const std::string& program, std::vector<std::string> arguments) {
  base::ChildProcess process = base::ChildProcess::StartReading({base::FindProgram(program), std::move(arguments)});
  std::string text;
  while (process.Receive(&text)) {
  }
  EXPECT_EQ(process.Wait().ShellStatus(), 0) << text;
  return text;
}

inline VideoFacts Inspect(const std::filesystem::path& file) {
  VideoFacts facts;
  std::istringstream lines(
      OutputOf("ffprobe", {"-v", "error", "-count_frames", "-show_entries", "stream=codec_name,width,height,r_frame_rate,nb_read_frames", "-of",
                           "default=noprint_wrappers=1", file.string()}));
  for (std::string line; std::getline(lines, line);) {
    const std::string value = line.substr(line.find('=') + 1);
    if (line.starts_with("codec_name")) facts.codec = value;
    if (line.starts_with("width")) facts.width = std::stoi(value);
    if (line.starts_with("height")) facts.height = std::stoi(value);
    if (line.starts_with("r_frame_rate")) facts.rate = value;
    if (line.starts_with("nb_read_frames")) facts.frames = std::stoi(value);
  }
  const std::string frame =
      OutputOf("ffmpeg", {"-v", "error", "-i", "file:" + file.string(), "-frames:v", "1", "-f", "rawvideo", "-pix_fmt", "rgb24", "pipe:1"});
  const size_t middle = (static_cast<size_t>(facts.height) / 2 * facts.width + facts.width / 2) * 3;
  EXPECT_EQ(frame.size(), static_cast<size_t>(facts.width) * facts.height * 3);
  for (size_t c = 0; c < 3 && middle + c < frame.size(); ++c) facts.middle[c] = static_cast<uint8_t>(frame[middle + c]);
  return facts;
}

}  // namespace skyquilt
