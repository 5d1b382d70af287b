// A running ffmpeg that takes raw frames on its standard input.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace skyquilt::products {

class FfmpegPipe {
 public:
  // Nothing when the program does not exist. Throws base::InputError for other failures to start.
  static std::optional<FfmpegPipe> Start(const std::string& program, const std::filesystem::path& file, int width, int height, int fps);
  FfmpegPipe(FfmpegPipe&& other) noexcept;
  FfmpegPipe& operator=(FfmpegPipe&& other) noexcept;
  ~FfmpegPipe();  // ends the program if it still runs

  // False when the program went away; Finish then tells why. Never raises SIGPIPE.
  bool Send(std::span<const uint8_t> bytes);
  // Closes the input and waits. Empty when it went well, otherwise the reason.
  std::string Finish();

 private:
  FfmpegPipe(pid_t process, int socket) : process_(process), socket_(socket) {}
  pid_t process_ = -1;
  int socket_ = -1;
};

}  // namespace skyquilt::products
