// Looks at a video once, small and with few frames per second, for the choice of its frames.
#pragma once

#include <filesystem>
#include <vector>

#include "prepare/video/choose_frames.h"
#include "prepare/video/probe.h"
#include "prepare/video/track.h"

namespace skyquilt::prepare::video {

struct VideoScan {
  VideoCandidates candidates;  // their times since the first frame
  double first_frame_s = 0.0;  // since the beginning of the file
  bool by_track = false;       // moved as the tracks say; else by tracked corners
  bool interlaced = false;     //
};

// How long videos are sampled.
struct ScanRate {
  double step_s = 0.0;
  bool key_frames_only = false;
};
// Six frames per second, and of videos of more than an hour at most 20,000, by key frames.
ScanRate ScanRateOf(const VideoInfo& info);

// Throws base::InputError for a video without frames; one that ends early is used as far as it goes, with a warning. Throws base::Interrupted.
VideoScan ScanVideo(const std::filesystem::path& video, const VideoInfo& info, const std::vector<FlightTrack>& tracks);

}  // namespace skyquilt::prepare::video
