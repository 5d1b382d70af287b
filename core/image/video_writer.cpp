#include "core/image/video_writer.h"

#include <cerrno>
#include <optional>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/output_file.h"

namespace skyquilt::image {
namespace {

constexpr const char* kFfmpeg = "ffmpeg";
constexpr const char* kFfmpegFix = "Check free space and that ffmpeg has libx264";

base::InputError Missing(const std::filesystem::path& file) {
  return {file, "cannot be written: the program ffmpeg is not installed", "Install it (Debian, Ubuntu: apt install ffmpeg)"};
}

// Starts an ffmpeg that reads raw frames from its standard input.
base::ChildProcess StartFfmpeg(const std::string& program, const std::filesystem::path& file, int width, int height, int fps) {
  const std::filesystem::path found = base::FindProgram(program);
  if (found.empty()) throw Missing(file);
  const std::string size = std::to_string(width) + "x" + std::to_string(height), rate = std::to_string(fps), output = "file:" + file.string();
  const std::vector<std::string> arguments = {"-hide_banner", "-loglevel",  "error",   "-nostats", "-y",   "-f", "rawvideo", "-pix_fmt",
                                              "rgb24",        "-s",         size,      "-r",       rate,   "-i", "pipe:0",   "-an",
                                              "-c:v",         "libx264",    "-preset", "medium",   "-crf", "18", "-pix_fmt", "yuv420p",
                                              "-movflags",    "+faststart", "-f",      "mp4",      output};
  try {
    return base::ChildProcess::StartWriting({found, arguments});
  } catch (const base::StartError& error) {
    // Treated as not installed; for instance a script whose interpreter is missing.
    if (error.missing() == base::StartError::Missing::kProgram && (error.code() == ENOENT || error.code() == EACCES)) throw Missing(file);
    const bool channel = error.missing() == base::StartError::Missing::kChannel;
    throw base::InputError(file, channel ? "cannot open a socket to ffmpeg" : "ffmpeg cannot be started", error.what());
  }
}

// Waits for ffmpeg to end. Returns the reason of a failure; empty when it succeeded.
std::string WaitForEnd(base::ChildProcess& ffmpeg) {
  const base::ChildEnd end = ffmpeg.Wait();
  return end.Text("ffmpeg") + (end.status == 0 ? "" : "; see its own message above");
}

}  // namespace

struct VideoWriter::Impl {
  std::filesystem::path file;
  base::PartialPath partial;
  int width = 0;
  int height = 0;
  bool closed = false;
  std::optional<base::ChildProcess> ffmpeg = {};  // ends before the partial file is removed
};

bool CanWriteVideos() {
  return !base::FindProgram(kFfmpeg).empty();
}

VideoWriter::VideoWriter(const std::filesystem::path& file, int width, int height, int fps, const std::string& ffmpeg)
    : impl_(new Impl{.file = file, .partial{file, std::filesystem::path(file).replace_extension(".partial.mp4")}, .width = width, .height = height}) {
  SKYQUILT_CHECK(width > 0 && height > 0 && width % 2 == 0 && height % 2 == 0, std::to_string(width) + " x " + std::to_string(height));
  SKYQUILT_CHECK(fps > 0, std::to_string(fps));
  impl_->ffmpeg = StartFfmpeg(ffmpeg, impl_->partial.path(), width, height, fps);
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::Write(const Image8& frame) {
  SKYQUILT_CHECK(frame.width == impl_->width && frame.height == impl_->height && frame.channels == 3,
                 std::to_string(frame.width) + " x " + std::to_string(frame.height));
  if (impl_->ffmpeg->Send(frame.data)) return;
  // A signal to the process group ends ffmpeg too; then this is not an error.
  base::ThrowIfCancelled();
  throw base::InputError(impl_->file, "cannot be written: " + WaitForEnd(*impl_->ffmpeg), kFfmpegFix);
}

void VideoWriter::Close() {
  SKYQUILT_CHECK(!impl_->closed, "closed twice");
  const std::string reason = WaitForEnd(*impl_->ffmpeg);
  impl_->ffmpeg.reset();
  if (!reason.empty()) {
    base::ThrowIfCancelled();
    throw base::InputError(impl_->file, "cannot be written: " + reason, kFfmpegFix);
  }
  impl_->partial.Publish();
  impl_->closed = true;
}

}  // namespace skyquilt::image
