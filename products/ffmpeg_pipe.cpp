#include "products/ffmpeg_pipe.h"

#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "core/base/errors.h"

namespace skyquilt::products {

std::optional<FfmpegPipe> FfmpegPipe::Start(const std::string& program, const std::filesystem::path& file, int width, int height, int fps) {
  // A socket instead of a pipe: send() can be told not to raise SIGPIPE when the program dies.
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw base::InputError(file, "no socket for ffmpeg", std::strerror(errno));
  const std::vector<std::string> words = {
      program,   "-hide_banner",      "-loglevel",  "error",  "-nostats", "-y",
      "-f",      "rawvideo",          "-pix_fmt",   "rgb24",  "-s",       std::to_string(width) + "x" + std::to_string(height),
      "-r",      std::to_string(fps), "-i",         "pipe:0", "-an",      "-c:v",
      "libx264", "-preset",           "medium",     "-crf",   "18",       "-pix_fmt",
      "yuv420p", "-movflags",         "+faststart", "-f",     "mp4",      "file:" + file.string()};
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  pid_t process = -1;
  const int error = posix_spawnp(&process, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error == 0) return FfmpegPipe(process, ends[0]);
  close(ends[0]);
  if (error == ENOENT || error == EACCES) return std::nullopt;
  throw base::InputError(file, "ffmpeg cannot be started", std::strerror(error));
}

FfmpegPipe::FfmpegPipe(FfmpegPipe&& other) noexcept : process_(std::exchange(other.process_, -1)), socket_(std::exchange(other.socket_, -1)) {}

FfmpegPipe& FfmpegPipe::operator=(FfmpegPipe&& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(socket_, other.socket_);
  return *this;
}

FfmpegPipe::~FfmpegPipe() {
  if (socket_ >= 0) close(socket_);
  if (process_ <= 0) return;
  kill(process_, SIGKILL);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool FfmpegPipe::Send(std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(sent));
  }
  return true;
}

std::string FfmpegPipe::Finish() {
  close(std::exchange(socket_, -1));
  int status = 0;
  const pid_t process = std::exchange(process_, -1);
  while (waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return std::string("waiting for ffmpeg failed: ") + std::strerror(errno);
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  if (WIFSIGNALED(status)) return "ffmpeg was ended by signal " + std::to_string(WTERMSIG(status));
  return "ffmpeg ended with status " + std::to_string(WEXITSTATUS(status)) + "; its own message stands above";
}

}  // namespace skyquilt::products
