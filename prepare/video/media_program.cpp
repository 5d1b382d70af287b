#include "prepare/video/media_program.h"

#include <algorithm>
#include <cerrno>
#include <sstream>

#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::prepare::video {
namespace {

base::InputError NotInstalled(const std::filesystem::path& video, const std::string& program) {
  return {video, "cannot be read: the program " + program + " is not installed",
          "Install ffmpeg (Debian, Ubuntu: apt install ffmpeg), or give photos instead of videos"};
}

}  // namespace

std::vector<std::string> InputArguments(const std::filesystem::path& file) {
  return {"-protocol_whitelist", "file", "-i", "file:" + file.string()};
}

base::ChildProcess StartMediaProgram(const std::string& program, const std::vector<std::string>& arguments, const std::filesystem::path& video) {
  const std::filesystem::path found = base::FindProgram(program);
  if (found.empty()) throw NotInstalled(video, program);
  try {
    return base::ChildProcess::StartReadingBoth({found, arguments});
  } catch (const base::StartError& error) {
    const bool no_program = error.missing() == base::StartError::Missing::kProgram && (error.code() == ENOENT || error.code() == EACCES);
    if (no_program) throw NotInstalled(video, program);
    throw base::InputError(video, program + " cannot be started to read it: " + error.what(), "Close other programs or free memory");
  }
}

ProgramOutput RunMediaProgram(const std::string& program, const std::vector<std::string>& arguments, const std::filesystem::path& video) {
  constexpr size_t kMost = size_t{1} << 28U;
  base::ChildProcess child = StartMediaProgram(program, arguments, video);
  ProgramOutput result;
  while (child.ReceiveBoth(&result.output, &result.messages)) {
    base::ThrowIfCancelled();
    result.output.resize(std::min(result.output.size(), kMost));
    result.messages.resize(std::min(result.messages.size(), kMost));
  }
  result.ok = child.Wait().ShellStatus() == 0;
  return result;
}

std::string LastMessage(const std::string& messages) {
  std::istringstream lines(messages);
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (!line.empty()) last = line;
  }
  constexpr size_t kLongest = 300;
  return last.substr(0, kLongest);
}

}  // namespace skyquilt::prepare::video
