// Starts ffmpeg and ffprobe, without a shell. Their messages are told when they fail.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/child_process.h"

namespace skyquilt::prepare::video {

// The arguments that name the input. A name that begins with '-' or has a ':' in it stays a file, and a file that is a play list opens nothing from
// elsewhere.
std::vector<std::string> InputArguments(const std::filesystem::path& file);

// Throws base::InputError about `video` when the program is not installed or cannot be started.
base::ChildProcess StartMediaProgram(const std::string& program, const std::vector<std::string>& arguments, const std::filesystem::path& video);

struct ProgramOutput {
  std::string output, messages;
  bool ok = false;
};
// To its end; what is longer than 256 MiB is cut off. Throws base::Interrupted when cancelled.
ProgramOutput RunMediaProgram(const std::string& program, const std::vector<std::string>& arguments, const std::filesystem::path& video);

// The last line that tells something, for a message; empty when there is none.
std::string LastMessage(const std::string& messages);

}  // namespace skyquilt::prepare::video
