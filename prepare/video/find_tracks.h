// The files beside a video, or the subtitles in it, that say where the drone was.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "prepare/video/probe.h"
#include "prepare/video/track.h"

namespace skyquilt::prepare::video {

// Of VIDEO.mp4: VIDEO.srt, VIDEO.gpx and VIDEO.csv, in any case; else any GPX file of the folder when there is just one. In this order; those that
// exist.
std::vector<std::filesystem::path> FilesBeside(const std::filesystem::path& video);

// By how much a log by UTC is later than the video's clock says, in seconds, so that it covers the video: 0 or whole quarters of an hour, as cameras
// write local time. The least that covers most; nothing when none covers half of the video. `duration_s`: of the video, above 0.
std::optional<double> ClockShift(double video_begin_s, double duration_s, double log_begin_s, double log_end_s);

// The tracks of a video, their times since its first frame, the better ones first. clock_offset_s: what the video's clock is behind UTC. Files that
// cannot be used are left out with a warning. `duration_s`: 0 when not known. Throws base::Interrupted.
std::vector<FlightTrack> FindTracks(const std::filesystem::path& video, const VideoInfo& info, double clock_offset_s);

// What the tracks say of a moment; where several know a number, the first one's.
TrackPoint StateByAll(std::span<const FlightTrack> tracks, double time_s);

}  // namespace skyquilt::prepare::video
