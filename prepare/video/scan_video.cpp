#include "prepare/video/scan_video.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "prepare/video/find_tracks.h"
#include "prepare/video/frame_stream.h"
#include "prepare/video/track_motion.h"

namespace skyquilt::prepare::video {
namespace {

constexpr double kFramesPerSecond = 6.0, kMostFrames = 20'000.0;
// Key frames are about a second apart: where no more are needed, the others need not be decoded.
constexpr double kKeyFrameStep_s = 0.5;
// Wide enough to tell a sharp frame from a blurred one.
constexpr int kScanWidth = 640;

// Puts the frames of a video into one frame, as far as corners say how they are related.
class MotionByCorners {
 public:
  void Add(const image::Image8& grey, double time_s, Candidate& candidate) {
    const std::optional<TrackedShift> tracked = tracker_.Track(grey);
    const double step_s = last_time_s_ ? time_s - *last_time_s_ : 0.0;
    if (tracked) {
      step_ = tracked->shift;
      known_ = true;
      from_first_ = from_first_.Then(step_);
    } else if (last_time_s_ && step_s > 0.0 && tracker_.HasCorners() && had_corners_) {
      ++section_;
      from_first_ = FrameShift();
      known_ = false;
    } else if (known_) {
      // Over water or in haze the drone flies on as before.
      from_first_ = from_first_.Then(step_);
    }
    had_corners_ = tracker_.HasCorners();
    last_time_s_ = time_s;
    candidate.from_first = from_first_;
    candidate.section = section_;
  }

 private:
  FrameTracker tracker_;
  FrameShift from_first_, step_;
  bool known_ = false, had_corners_ = false;
  int section_ = 0;
  std::optional<double> last_time_s_;
};

void WarnOfEarlyEnd(const std::filesystem::path& video, const VideoInfo& info, double seen_s, double step_s, const std::string& problem) {
  const double missing_s = info.duration_s.value_or(0.0) - seen_s;
  if (missing_s <= std::max({2.0, 3.0 * step_s, 0.02 * info.duration_s.value_or(0.0)})) {
    if (!problem.empty()) base::LogWarning("{}: parts are damaged, frames from there may be bad; ffmpeg says: {}", video.string(), problem);
    return;
  }
  base::LogWarning(
      "{}: ends after {:.0f} of {:.0f} s: the file is cut off or damaged there{}. Frames up to there are used; copy it from the card again "
      "to have the rest",
      video.string(), seen_s, *info.duration_s, problem.empty() ? "" : " (ffmpeg: " + problem + ")");
}

}  // namespace

ScanRate ScanRateOf(const VideoInfo& info) {
  const double step_s = std::max(1.0 / kFramesPerSecond, info.duration_s.value_or(0.0) / kMostFrames);
  return {.step_s = step_s, .key_frames_only = step_s >= kKeyFrameStep_s};
}

VideoScan ScanVideo(const std::filesystem::path& video, const VideoInfo& info, const std::vector<FlightTrack>& tracks) {
  const ScanRate rate = ScanRateOf(info);
  const int width = std::min(info.width, kScanWidth);
  const int height = std::max(1, static_cast<int>(std::lround(static_cast<double>(width) * info.height / info.width)));
  VideoScan scan;
  scan.candidates.aspect = static_cast<double>(info.height) / info.width;
  std::vector<Candidate>& candidates = scan.candidates.candidates;
  // A twentieth less: frames that come a little early are not missed.
  FrameStream frames(
      {.video = video, .width = width, .height = height, .grey = true, .key_frames_only = rate.key_frames_only, .step_s = 0.95 * rate.step_s});
  MotionByCorners corners;
  size_t n_interlaced = 0;
  base::Progress progress("look at " + video.filename().string(), info.duration_s.value_or(0.0), "s");
  for (VideoFrame frame; frames.Next(&frame);) {
    if (candidates.empty()) scan.first_frame_s = frame.time_s;
    Candidate candidate{.time_s = frame.time_s - scan.first_frame_s, .sharpness = SharpnessOf(frame.pixels)};
    // Damaged files jump back in time.
    if (!candidates.empty() && candidate.time_s <= candidates.back().time_s) continue;
    corners.Add(frame.pixels, candidate.time_s, candidate);
    n_interlaced += frame.interlaced ? 1 : 0;
    candidates.push_back(candidate);
    progress.Update(candidate.time_s);
  }
  progress.Finish();
  if (candidates.empty()) {
    throw base::InputError(video, "gives no frames" + (frames.Problem().empty() ? "" : " (ffmpeg: " + frames.Problem() + ")"),
                           "Copy the video from the card again; where that does not help, convert it with 'ffmpeg -i VIDEO -crf 16 NEW.mp4'");
  }
  WarnOfEarlyEnd(video, info, candidates.back().time_s, rate.step_s, frames.Problem());
  scan.interlaced = info.interlaced || 2 * n_interlaced > candidates.size();
  std::vector<TrackPoint> states;
  states.reserve(candidates.size());
  for (const Candidate& candidate : candidates) states.push_back(StateByAll(tracks, candidate.time_s));
  if (const auto shifts = ShiftsByTrack(states)) {
    scan.by_track = true;
    for (size_t i = 0; i < candidates.size(); ++i) {
      candidates[i].from_first = (*shifts)[i];
      candidates[i].section = 0;
    }
  }
  return scan;
}

}  // namespace skyquilt::prepare::video
