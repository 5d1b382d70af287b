#include "prepare/video/find_tracks.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "prepare/video/csv_track.h"
#include "prepare/video/gpx.h"
#include "prepare/video/media_program.h"
#include "prepare/video/subtitles.h"

namespace skyquilt::prepare::video {
namespace {

namespace fs = std::filesystem;

std::string ExtensionOf(const fs::path& file) {
  return base::LowerCase(file.extension().string());
}

// Seconds of the video that the log covers.
double CoveredSeconds(double begin_s, double end_s, double log_begin_s, double log_end_s) {
  return std::max(0.0, std::min(end_s, log_end_s) - std::max(begin_s, log_begin_s));
}

// Turns times by UTC into those of the video. False, with a warning, when the log does not cover it.
bool MoveToVideo(const VideoInfo& info, double clock_offset_s, FlightTrack& track) {
  if (!track.by_clock) return true;
  if (!info.created_clock_s) {
    base::LogWarning("{}: not used, because the video does not say when it was recorded; write the times since its beginning into a CSV file instead",
                     track.file.string());
    return false;
  }
  const double begin_s = *info.created_clock_s + clock_offset_s, duration_s = info.duration_s.value_or(1.0);
  const double log_begin_s = track.points.front().time_s, log_end_s = track.points.back().time_s;
  const std::optional<double> shift_s = ClockShift(begin_s, duration_s, log_begin_s, log_end_s);
  if (!shift_s) {
    base::LogWarning(
        "{}: not used, because it covers none or little of the video, which begins {:.0f} s after it; set prepare.video_clock_offset_s "
        "where the camera's clock was wrong",
        track.file.string(), begin_s - log_begin_s);
    return false;
  }
  if (*shift_s != 0.0) {
    base::LogInfo("{}: the video's clock is taken for a local time, {:+.2f} hours from UTC", track.file.string(), -*shift_s / 3600.0);
  }
  for (TrackPoint& point : track.points) point.time_s -= begin_s + *shift_s;
  track.by_clock = false;
  return true;
}

// The recording of the log that is about as long as the video.
std::vector<FlightTrack> RecordingLike(const VideoInfo& info, std::vector<FlightTrack> tracks) {
  if (tracks.size() <= 1) return tracks;
  constexpr double kMostDifferent_s = 3.0;
  const auto length_s = [](const FlightTrack& track) { return track.points.empty() ? 0.0 : track.points.back().time_s; };
  const auto best = std::min_element(tracks.begin(), tracks.end(), [&](const FlightTrack& a, const FlightTrack& b) {
    return std::abs(length_s(a) - info.duration_s.value_or(0.0)) < std::abs(length_s(b) - info.duration_s.value_or(0.0));
  });
  if (std::abs(length_s(*best) - info.duration_s.value_or(0.0)) > kMostDifferent_s) {
    base::LogWarning("{}: not used, because none of its {} recordings is as long as the video", best->file.string(), tracks.size());
    return {};
  }
  return {*best};
}

std::vector<FlightTrack> ReadTracks(const fs::path& file, const VideoInfo& info) {
  const std::string extension = ExtensionOf(file);
  if (extension == ".srt") return {ReadSubtitles(file)};
  if (extension == ".gpx") return {ReadGpx(file)};
  return RecordingLike(info, ReadCsvTracks(file));
}

// ffmpeg writes subtitles of any form as SRT.
FlightTrack EmbeddedSubtitles(const fs::path& video) {
  std::vector<std::string> arguments = {"-hide_banner", "-nostdin", "-nostats", "-loglevel", "error"};
  const std::vector<std::string> input = InputArguments(video);
  arguments.insert(arguments.end(), input.begin(), input.end());
  arguments.insert(arguments.end(), {"-map", "0:s:0", "-f", "srt", "pipe:1"});
  const ProgramOutput text = RunMediaProgram("ffmpeg", arguments, video);
  std::istringstream in(text.output);
  return ParseSubtitles(in, video);
}

template <typename Value>
void Fill(std::optional<Value>& known, const std::optional<Value>& other) {
  if (!known) known = other;
}

}  // namespace

std::vector<fs::path> FilesBeside(const fs::path& video) {
  std::vector<fs::path> of_video, gpx;
  const std::string stem = base::LowerCase(video.stem().string());
  std::error_code error;
  const fs::path folder = video.has_parent_path() ? video.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const fs::path& file = entry->path();
    const std::string extension = ExtensionOf(file);
    if (extension == ".gpx") gpx.push_back(file);
    const bool of_this = base::LowerCase(file.stem().string()) == stem;
    if (of_this && (extension == ".srt" || extension == ".gpx" || extension == ".csv")) of_video.push_back(file);
  }
  const auto has_gpx = std::any_of(of_video.begin(), of_video.end(), [](const fs::path& file) { return ExtensionOf(file) == ".gpx"; });
  if (!has_gpx && gpx.size() == 1) of_video.push_back(gpx.front());
  const auto rank = [](const fs::path& file) { return ExtensionOf(file) == ".srt" ? 0 : ExtensionOf(file) == ".gpx" ? 1 : 2; };
  std::sort(of_video.begin(), of_video.end(), [&](const fs::path& a, const fs::path& b) { return std::pair(rank(a), a) < std::pair(rank(b), b); });
  return of_video;
}

std::optional<double> ClockShift(double video_begin_s, double duration_s, double log_begin_s, double log_end_s) {
  constexpr double kQuarter_s = 900.0;
  constexpr int kMostQuarters = 56;
  constexpr double kLeastShare = 0.5, kBetter = 1.02;
  double best_s = 0.0, shift_s = 0.0;
  for (int i = 0; i <= 2 * kMostQuarters; ++i) {
    // 0, 1, -1, 2, -2, ...
    const double tried_s = kQuarter_s * (i % 2 == 1 ? (i + 1) / 2 : -i / 2);
    const double covered_s = CoveredSeconds(video_begin_s + tried_s, video_begin_s + tried_s + duration_s, log_begin_s, log_end_s);
    if (covered_s <= kBetter * best_s) continue;
    best_s = covered_s;
    shift_s = tried_s;
  }
  return best_s >= kLeastShare * duration_s ? std::optional(shift_s) : std::nullopt;
}

std::vector<FlightTrack> FindTracks(const fs::path& video, const VideoInfo& info, double clock_offset_s) {
  std::vector<FlightTrack> found;
  const auto take = [&](FlightTrack track, const std::string& from) {
    if (track.points.empty()) {
      base::LogWarning("{}: says nothing of the flight", from);
      return;
    }
    if (MoveToVideo(info, clock_offset_s, track)) found.push_back(std::move(track));
  };
  bool has_subtitles = false;
  for (const fs::path& file : FilesBeside(video)) {
    has_subtitles = has_subtitles || ExtensionOf(file) == ".srt";
    try {
      std::vector<FlightTrack> tracks = ReadTracks(file, info);
      for (FlightTrack& track : tracks) take(std::move(track), file.string());
    } catch (const base::InputError& error) {
      base::LogWarning("not used: {}", error.what());
    }
  }
  if (!has_subtitles && info.has_subtitles) {
    FlightTrack track = EmbeddedSubtitles(video);
    // Those of films are no fault.
    if (!track.points.empty()) found.insert(found.begin(), std::move(track));
  }
  return found;
}

TrackPoint StateByAll(std::span<const FlightTrack> tracks, double time_s) {
  TrackPoint all{.time_s = time_s};
  for (const FlightTrack& track : tracks) {
    const std::optional<TrackPoint> state = StateAt(track, time_s);
    if (!state) continue;
    if (!all.latitude_deg && state->latitude_deg) {
      all.latitude_deg = state->latitude_deg;
      all.longitude_deg = state->longitude_deg;
    }
    Fill(all.altitude_m, state->altitude_m);
    Fill(all.relative_altitude_m, state->relative_altitude_m);
    Fill(all.gimbal_yaw_deg, state->gimbal_yaw_deg);
    Fill(all.gimbal_pitch_deg, state->gimbal_pitch_deg);
    Fill(all.gimbal_roll_deg, state->gimbal_roll_deg);
    Fill(all.exposure_time_s, state->exposure_time_s);
    Fill(all.f_number, state->f_number);
    Fill(all.iso, state->iso);
    Fill(all.focal_35mm, state->focal_35mm);
    Fill(all.clock_s, state->clock_s);
  }
  return all;
}

}  // namespace skyquilt::prepare::video
