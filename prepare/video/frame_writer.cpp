#include "prepare/video/frame_writer.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/cancel.h"
#include "core/base/log.h"
#include "core/base/output_file.h"
#include "core/base/progress.h"
#include "core/image/image.h"
#include "prepare/video/frame_stream.h"

namespace skyquilt::prepare::video {
namespace {

namespace fs = std::filesystem;

constexpr int kJpegQuality = 95;
// Decoding what lies between two frames takes less time than a new start where they are nearer than this.
constexpr double kLongestGap_s = 5.0;
// So many terms of a filter's expression are safe.
constexpr size_t kMostOfOneStart = 40;

void WriteFrame(const image::Image8& pixels, const FrameToWrite& frame, const fs::path& folder) {
  // Hidden, so that what a killed process leaves is no photo.
  base::PartialPath partial(folder / frame.name, folder / ("." + frame.name));
  image::SaveJpeg(pixels, partial.path(), kJpegQuality);
  survey::WritePhotoTags(frame.tags, partial.path());
  partial.Publish();
}

}  // namespace

std::set<std::string> WriteFrames(const fs::path& video, const VideoInfo& info, bool interlaced, int size, const std::vector<FrameToWrite>& frames,
                                  const fs::path& folder) {
  std::vector<const FrameToWrite*> wanted;
  for (const FrameToWrite& frame : frames) {
    if (!fs::exists(folder / frame.name)) wanted.push_back(&frame);
  }
  const double scale = size > 0 ? std::min(1.0, static_cast<double>(size) / std::max(info.width, info.height)) : 1.0;
  FrameRequest request{.video = video,
                       .width = std::max(1, static_cast<int>(std::lround(scale * info.width))),
                       .height = std::max(1, static_cast<int>(std::lround(scale * info.height))),
                       .deinterlace = interlaced,
                       .skip_to_spans = info.has_index};
  // Nearer to the frame than to its neighbours.
  const double reach_s = 0.4 / std::clamp(info.frames_per_s > 0.0 ? info.frames_per_s : 30.0, 1.0, 240.0);
  std::set<std::string> missing;
  base::Progress progress("take frames of " + video.filename().string(), static_cast<double>(frames.size()), "frames",
                          static_cast<double>(frames.size() - wanted.size()));
  for (size_t begin = 0; begin < wanted.size();) {
    size_t end = begin + 1;
    const auto near = [&] { return end - begin < kMostOfOneStart && wanted[end]->file_time_s - wanted[end - 1]->file_time_s < kLongestGap_s; };
    while (end < wanted.size() && (!info.has_index || near())) ++end;
    request.spans.clear();
    for (size_t i = begin; i < end; ++i) request.spans.push_back({wanted[i]->file_time_s - reach_s, wanted[i]->file_time_s + reach_s});
    FrameStream stream(request);
    size_t next = begin;
    for (VideoFrame frame; next < end && stream.Next(&frame);) {
      // Those that were passed are not there.
      while (next < end && wanted[next]->file_time_s + reach_s < frame.time_s) missing.insert(wanted[next++]->name);
      if (next == end || frame.time_s < wanted[next]->file_time_s - reach_s) continue;
      WriteFrame(frame.pixels, *wanted[next++], folder);
      progress.Advance();
    }
    while (next < end) missing.insert(wanted[next++]->name);
    begin = end;
  }
  progress.Finish();
  return missing;
}

}  // namespace skyquilt::prepare::video
