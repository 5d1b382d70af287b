#include "prepare/video/frame_stream.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "prepare/video/media_program.h"
#include "prepare/video/track.h"

namespace skyquilt::prepare::video {
namespace {

// The filter that says of every frame that it lets through which one it is.
constexpr const char* kNote = "showinfo";

std::string FilterOf(const FrameRequest& request, double offset_s) {
  std::string filter;
  // Before frames are left out: it looks at neighbours.
  if (request.deinterlace) filter += "yadif=deint=interlaced,";
  if (!request.spans.empty()) {
    std::string within;
    for (const TimeSpan& span : request.spans) {
      within += fmt::format("{}between(t,{:.6f},{:.6f})", within.empty() ? "" : "+", span.from_s - offset_s, span.to_s - offset_s);
    }
    filter += "select='" + within + "',";
  } else if (request.step_s > 0.0) {
    filter += fmt::format("select='isnan(prev_selected_t)+gte(t-prev_selected_t,{:.6f})',", request.step_s);
  }
  filter += fmt::format("scale={}:{}:flags={},setsar=1,format={},showinfo=checksum=0", request.width, request.height,
                        request.grey ? "area" : "bicubic+accurate_rnd+full_chroma_int", request.grey ? "gray" : "rgb24");
  return filter;
}

base::ChildProcess StartDecoding(const FrameRequest& request, double offset_s) {
  std::vector<std::string> arguments = {"-hide_banner", "-nostdin", "-nostats", "-loglevel", "info"};
  if (request.key_frames_only) arguments.insert(arguments.end(), {"-skip_frame", "nokey"});
  if (offset_s > 0.0) arguments.insert(arguments.end(), {"-ss", fmt::format("{:.6f}", offset_s)});
  // Hours behind the last frame that is wanted would be decoded for nothing.
  constexpr double kLater_s = 2.0;
  if (!request.spans.empty() && request.skip_to_spans) {
    arguments.insert(arguments.end(), {"-t", fmt::format("{:.6f}", request.spans.back().to_s - offset_s + kLater_s)});
  }
  const std::vector<std::string> input = InputArguments(request.video);
  arguments.insert(arguments.end(), input.begin(), input.end());
  // V: the first video that is no still picture such as a cover.
  arguments.insert(arguments.end(), {"-map", "0:V:0", "-an", "-sn", "-dn", "-vf", FilterOf(request, offset_s), "-fps_mode", "passthrough", "-f",
                                     "rawvideo", "-pix_fmt", request.grey ? "gray" : "rgb24", "pipe:1"});
  return StartMediaProgram("ffmpeg", arguments, request.video);
}

// Decoding begins a little before the first frame that is wanted, and times count from there.
double OffsetOf(const FrameRequest& request) {
  constexpr double kEarlier_s = 0.5;
  return request.spans.empty() || !request.skip_to_spans ? 0.0 : std::max(0.0, request.spans.front().from_s - kEarlier_s);
}

// The number behind a name in a line of showinfo.
std::optional<double> NumberIn(const std::string& line, const std::string& name) {
  const size_t at = line.find(name);
  return at == std::string::npos ? std::nullopt : LeadingNumber(std::string_view(line).substr(at + name.size()));
}

}  // namespace

FrameStream::FrameStream(const FrameRequest& request) : request_(request), offset_s_(OffsetOf(request)), ffmpeg_(StartDecoding(request, offset_s_)) {
  SKYQUILT_CHECK(request.width > 0 && request.height > 0, std::to_string(request.width) + " x " + std::to_string(request.height));
}

bool FrameStream::Next(VideoFrame* frame) {
  const size_t n_bytes = static_cast<size_t>(request_.width) * static_cast<size_t>(request_.height) * (request_.grey ? 1 : 3);
  while (!ended_ && (output_.size() < n_bytes || notes_.empty())) {
    base::ThrowIfCancelled();
    const bool more = ffmpeg_.ReceiveBoth(&output_, &messages_);
    ReadNotes();
    if (!more) End();
  }
  if (output_.size() < n_bytes || notes_.empty()) return false;
  frame->time_s = notes_.front().time_s;
  frame->interlaced = notes_.front().interlaced;
  notes_.erase(notes_.begin());
  frame->pixels = image::Image8(request_.width, request_.height, request_.grey ? 1 : 3);
  std::copy_n(output_.begin(), n_bytes, reinterpret_cast<char*>(frame->pixels.data.data()));
  output_.erase(0, n_bytes);
  return true;
}

void FrameStream::ReadNotes() {
  size_t begin = 0;
  for (size_t end = messages_.find('\n'); end != std::string::npos; end = messages_.find('\n', begin)) {
    ReadNote(messages_.substr(begin, end - begin));
    begin = end + 1;
  }
  messages_.erase(0, begin);
}

void FrameStream::ReadNote(const std::string& line) {
  if (line.find(kNote) != std::string::npos) {
    if (line.find("config in time_base:") != std::string::npos) {
      const size_t slash = line.find('/', line.find("time_base:"));
      const std::optional<double> over = NumberIn(line, "time_base:");
      const std::optional<double> under = slash == std::string::npos ? std::nullopt : LeadingNumber(std::string_view(line).substr(slash + 1));
      if (over && under && *under > 0.0) time_base_s_ = *over / *under;
      return;
    }
    const std::optional<double> number = NumberIn(line, " n:");
    if (!number) return;
    // pts_time has six digits, too few for hours.
    const std::optional<double> ticks = NumberIn(line, " pts:");
    const std::optional<double> time_s = ticks && time_base_s_ > 0.0 ? std::optional(*ticks * time_base_s_) : NumberIn(line, "pts_time:");
    const bool interlaced = line.find(" i:T") != std::string::npos || line.find(" i:B") != std::string::npos;
    notes_.push_back({time_s.value_or(0.0) + offset_s_, interlaced});
    return;
  }
  // Of ffmpeg's many lines those that tell of damage.
  for (const char* word : {"rror", "nvalid", "orrupt", "runcated", "damaged", "missing", "partial file", "not found"}) {
    if (line.find(word) != std::string::npos) problem_ = line.substr(0, 300);
  }
}

void FrameStream::End() {
  ended_ = true;
  if (!messages_.empty()) ReadNote(messages_);
  const base::ChildEnd end = ffmpeg_.Wait();
  if (problem_.empty()) problem_ = end.Text("ffmpeg");
}

}  // namespace skyquilt::prepare::video
