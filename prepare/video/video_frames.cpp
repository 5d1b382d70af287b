#include "prepare/video/video_frames.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "prepare/input/photo_files.h"
#include "prepare/tables/csv_field.h"
#include "prepare/video/find_tracks.h"
#include "prepare/video/find_videos.h"
#include "prepare/video/frame_writer.h"
#include "prepare/video/scan_video.h"

namespace skyquilt::prepare::video {
namespace {

namespace fs = std::filesystem;

constexpr const char *kPlanName = "frames.json", *kTableName = "frames.csv";

// A video with what is known of it before its frames are taken.
struct Source {
  fs::path video;
  VideoInfo info;
  std::vector<FlightTrack> tracks;
};

std::string IdentityOf(const std::vector<fs::path>& videos, const VideoOptions& options) {
  return fmt::format("frames of videos, form 1\n{} {} {} {}\n", options.overlap, options.limit, options.size, options.clock_offset_s) +
         VideosIdentity(videos);
}

// Different for each video, and usable in file names everywhere.
std::vector<std::string> StemsOf(const std::vector<fs::path>& videos) {
  std::set<std::string> taken;
  std::vector<std::string> stems;
  for (const fs::path& video : videos) {
    std::string stem = video.stem().string();
    std::replace_if(
        stem.begin(), stem.end(), [](char c) { return std::string_view(" \\:*?\"<>|,;'").find(c) != std::string_view::npos; }, '_');
    std::string name = stem;
    for (int i = 2; !taken.insert(name).second; ++i) name = stem + "-" + std::to_string(i);
    stems.push_back(name);
  }
  return stems;
}

void LogSource(const Source& source) {
  const VideoInfo& info = source.info;
  std::string text = fmt::format("{}: {} x {} pixels", source.video.string(), info.width, info.height);
  if (info.duration_s) text += fmt::format(", {:.0f} s", *info.duration_s);
  if (info.frames_per_s > 0.0) text += fmt::format(" of {:.4g} frames per second", info.frames_per_s);
  if (info.rotation_deg != 0) text += fmt::format(", turned by {} degrees, as it says", info.rotation_deg);
  for (const FlightTrack& track : source.tracks)
    text += fmt::format("; {} from {} ({} moments)", track.form, track.file.string(), track.points.size());
  if (source.tracks.empty()) text += "; no file beside it (.SRT, .GPX, .CSV) says where it was";
  base::LogInfo(text);
}

std::vector<Source> ReadSources(const std::vector<fs::path>& videos, const VideoOptions& options) {
  std::vector<Source> sources;
  for (const fs::path& video : videos) {
    Source source{.video = video, .info = Probe(video), .tracks = {}};
    source.tracks = FindTracks(video, source.info, options.clock_offset_s);
    LogSource(source);
    sources.push_back(std::move(source));
  }
  return sources;
}

std::string ReasonText(const ChosenFrame& frame, bool by_track) {
  const char* by = by_track ? "by place and height" : "by tracked corners";
  const std::string overlap = fmt::format("{:.0f} % overlap {}", 100.0 * std::max(0.0, frame.overlap), by);
  switch (frame.reason) {
    case FrameReason::kFirst:
      return fmt::format("first, sharpest of {}", frame.n_compared);
    case FrameReason::kJump:
      return fmt::format("first after a jump of the picture, sharpest of {}", frame.n_compared);
    case FrameReason::kOverlap:
      return fmt::format("{}, sharpest of {}", overlap, frame.n_compared);
    case FrameReason::kSharper:
      return overlap + ", those with less are blurred";
    case FrameReason::kFast:
      return overlap + ": the picture moves fast";
    case FrameReason::kLast:
      return overlap + ", last before a jump or the end";
  }
  return "";
}

void LogChoice(const FrameChoice& choice, const VideoOptions& options, const std::vector<VideoCandidates>& videos) {
  size_t n_frames = 0, n_candidates = 0, n_jumps = 0, n_fast = 0;
  for (const std::vector<ChosenFrame>& frames : choice.frames) {
    n_frames += frames.size();
    for (const ChosenFrame& frame : frames) {
      n_jumps += frame.reason == FrameReason::kJump ? 1 : 0;
      n_fast += frame.reason == FrameReason::kFast ? 1 : 0;
    }
  }
  for (const VideoCandidates& video : videos) n_candidates += video.candidates.size();
  base::LogInfo("{} frames are chosen of {} looked at, for {:.0f} % overlap", n_frames, n_candidates, 100.0 * choice.overlap);
  if (choice.thinned) {
    base::LogWarning(
        "the limit of {} frames leaves no overlap between neighbours: most of them will get no pose. Raise prepare.video_limit, or cut "
        "the videos to what matters",
        options.limit);
  } else if (choice.overlap < options.overlap - 0.02) {
    base::LogWarning(
        "{:.0f} % overlap would take more than {} frames: they have {:.0f} % overlap. Raise prepare.video_limit where photos get no pose",
        100.0 * options.overlap, options.limit, 100.0 * choice.overlap);
  }
  if (n_jumps > 0) base::LogInfo("the picture jumps {} times (cuts, or fast turns): frames before and after are chosen apart", n_jumps);
  if (10 * n_fast > n_frames) {
    base::LogWarning("{} of {} frames overlap less than asked for, because the picture moves fast between frames", n_fast, n_frames);
  }
}

// Chooses the frames of all videos.
nlohmann::ordered_json MakePlan(const std::vector<Source>& sources, const VideoOptions& options, const std::string& identity) {
  std::vector<VideoScan> scans;
  std::vector<VideoCandidates> videos;
  std::vector<fs::path> files;
  for (const Source& source : sources) {
    scans.push_back(ScanVideo(source.video, source.info, source.tracks));
    videos.push_back(scans.back().candidates);
    files.push_back(source.video);
    if (scans.back().interlaced) base::LogWarning("{}: interlaced; its fields are put together, which costs sharpness", source.video.string());
  }
  const FrameChoice choice = ChooseFramesOfAll(videos, options.overlap, options.limit);
  LogChoice(choice, options, videos);
  const std::vector<std::string> stems = StemsOf(files);
  nlohmann::ordered_json plan = {{"made_from", identity}, {"videos", nlohmann::ordered_json::array()}};
  size_t n_frames = 0;
  for (size_t v = 0; v < sources.size(); ++v) {
    nlohmann::ordered_json frames = nlohmann::ordered_json::array();
    for (const ChosenFrame& chosen : choice.frames[v]) {
      const Candidate& candidate = videos[v].candidates[chosen.candidate];
      frames.push_back({{"name", fmt::format("{}_{:08d}ms.jpg", stems[v], std::llround(1000.0 * candidate.time_s))},
                        {"time_s", candidate.time_s},
                        {"reason", ReasonText(chosen, scans[v].by_track)},
                        {"overlap", chosen.overlap},
                        {"sharpness", candidate.sharpness}});
    }
    n_frames += frames.size();
    plan["videos"].push_back({{"first_frame_s", scans[v].first_frame_s}, {"interlaced", scans[v].interlaced}, {"frames", std::move(frames)}});
  }
  if (n_frames < static_cast<size_t>(input::kMinPhotos)) {
    throw base::InputError(
        sources.front().video,
        fmt::format("shows only {} places that overlap by {:.0f} %, at least {} are needed", n_frames, 100.0 * options.overlap, input::kMinPhotos),
        "Give a video in which the camera moves, or set prepare.video_overlap nearer to 1");
  }
  return plan;
}

// Of an earlier call; null: there is none of the same videos and options.
nlohmann::ordered_json ReadPlan(const fs::path& file, const std::string& identity, size_t n_videos) {
  if (!fs::exists(file)) return nullptr;
  try {
    nlohmann::ordered_json plan = base::ParseOrderedJson(base::ReadFile(file));
    if (plan.at("made_from").get<std::string>() == identity && plan.at("videos").size() == n_videos) return plan;
  } catch (const nlohmann::json::exception&) {
    // Whatever it is, it is made anew.
  }
  return nullptr;
}

std::vector<FrameToWrite> FramesOf(const nlohmann::ordered_json& video, const Source& source) {
  double step_deg = 0.0;
  for (const FlightTrack& track : source.tracks) step_deg = step_deg > 0.0 ? step_deg : track.position_step_deg;
  std::vector<FrameToWrite> frames;
  for (const nlohmann::ordered_json& frame : video.at("frames")) {
    FrameToWrite& one = frames.emplace_back();
    one.name = frame.at("name").get<std::string>();
    const double time_s = frame.at("time_s").get<double>();
    one.file_time_s = time_s + video.at("first_frame_s").get<double>();
    TrackPoint state = StateByAll(source.tracks, time_s);
    if (!state.clock_s && source.info.created_clock_s) state.clock_s = *source.info.created_clock_s + time_s;
    one.tags = TagsOf(state, step_deg);
  }
  return frames;
}

std::string TableOf(const nlohmann::ordered_json& plan, const std::vector<Source>& sources, const std::vector<std::vector<FrameToWrite>>& frames,
                    const std::set<std::string>& missing) {
  std::string text =
      "frame,video,time_s,taken,reason,overlap,sharpness,latitude_deg,longitude_deg,altitude_m,relative_altitude_m,gimbal_yaw_deg,gimbal_pitch_deg\n";
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  for (size_t v = 0; v < sources.size(); ++v) {
    const nlohmann::ordered_json& planned = plan.at("videos")[v].at("frames");
    for (size_t i = 0; i < frames[v].size(); ++i) {
      const survey::PhotoTags& tags = frames[v][i].tags;
      const bool taken = !missing.contains(frames[v][i].name);
      const std::string reason = planned[i].at("reason").get<std::string>() + (taken ? "" : "; left out, because it cannot be decoded");
      using tables::CsvNumber;
      text += tables::CsvText(frames[v][i].name) + "," + tables::CsvText(sources[v].video.filename().string()) + "," +
              CsvNumber(planned[i].at("time_s").get<double>(), 3) + (taken ? ",yes," : ",no,") + tables::CsvText(reason) + "," +
              CsvNumber(planned[i].at("overlap").get<double>(), 3) + "," + CsvNumber(planned[i].at("sharpness").get<double>(), 1) + "," +
              CsvNumber(tags.gps ? tags.gps->latitude_deg : kUnknown, 8) + "," + CsvNumber(tags.gps ? tags.gps->longitude_deg : kUnknown, 8) + "," +
              CsvNumber(tags.gps ? tags.gps->height_m : kUnknown, 3) + "," + CsvNumber(tags.relative_altitude_m.value_or(kUnknown), 3) + "," +
              CsvNumber(tags.gimbal_yaw_deg.value_or(kUnknown), 2) + "," + CsvNumber(tags.gimbal_pitch_deg.value_or(kUnknown), 2) + "\n";
    }
  }
  return text;
}

bool AllAreThere(const nlohmann::ordered_json& plan, const fs::path& folder) {
  if (!fs::exists(folder / kTableName)) return false;
  const std::set<std::string> missing = plan.value("left_out", std::set<std::string>());
  for (const nlohmann::ordered_json& video : plan.at("videos")) {
    for (const nlohmann::ordered_json& frame : video.at("frames")) {
      const std::string name = frame.at("name").get<std::string>();
      if (!missing.contains(name) && !fs::exists(FramesFolder(folder) / name)) return false;
    }
  }
  return true;
}

// Hidden files that a killed process has left.
void RemoveUnfinished(const fs::path& frames) {
  std::vector<fs::path> unfinished;
  for (const fs::directory_entry& entry : fs::directory_iterator(frames)) {
    if (entry.path().filename().string().starts_with('.')) unfinished.push_back(entry.path());
  }
  for (const fs::path& file : unfinished) fs::remove(file);
}

}  // namespace

fs::path FramesFolder(const fs::path& folder) {
  return folder / "frames";
}

survey::PhotoTags TagsOf(const TrackPoint& state, double position_step_deg) {
  survey::PhotoTags tags;
  if (state.latitude_deg && state.longitude_deg) {
    tags.gps = geo::Geodetic{*state.latitude_deg, *state.longitude_deg, state.altitude_m.value_or(std::numeric_limits<double>::quiet_NaN())};
  }
  // A position that is rounded is less accurate than the usual one of consumer GPS.
  constexpr double kUsual_m = 3.0, kDegree_m = 111'320.0;
  const double rounding_m = position_step_deg * kDegree_m / std::sqrt(12.0);
  if (tags.gps && rounding_m > 0.3) tags.horizontal_accuracy_m = std::hypot(kUsual_m, rounding_m);
  tags.relative_altitude_m = state.relative_altitude_m;
  // As in photos of drones: heights by the barometer, which starts at the height of take-off above sea level.
  if (state.relative_altitude_m) tags.absolute_altitude_m = state.altitude_m;
  tags.gimbal_yaw_deg = state.gimbal_yaw_deg;
  tags.gimbal_pitch_deg = state.gimbal_pitch_deg;
  tags.gimbal_roll_deg = state.gimbal_roll_deg;
  tags.exposure = {state.exposure_time_s, state.f_number, state.iso};
  if (state.focal_35mm && survey::IsPlausibleFocal35(*state.focal_35mm)) tags.focal_length_35mm = state.focal_35mm;
  tags.capture_time_s = state.clock_s;
  return tags;
}

void ProvideFrames(const std::vector<fs::path>& videos, const VideoOptions& options, const fs::path& folder) {
  base::RequireWritableFolder(folder);
  const std::string identity = IdentityOf(videos, options);
  nlohmann::ordered_json plan = ReadPlan(folder / kPlanName, identity, videos.size());
  if (!plan.is_null() && AllAreThere(plan, folder)) {
    base::LogInfo("frames of the videos are already taken, in {}", FramesFolder(folder).string());
    return;
  }
  const std::vector<Source> sources = ReadSources(videos, options);
  if (plan.is_null()) {
    // Names of frames of other videos may be the same.
    fs::remove(folder / kTableName);
    fs::remove(folder / kPlanName);
    fs::remove_all(FramesFolder(folder));
    plan = MakePlan(sources, options, identity);
    base::WriteFileAtomically(folder / kPlanName, base::JsonText(plan, 1) + "\n");
  }
  base::RequireWritableFolder(FramesFolder(folder));
  RemoveUnfinished(FramesFolder(folder));
  std::vector<std::vector<FrameToWrite>> frames;
  std::set<std::string> missing;
  size_t n_frames = 0;
  for (size_t v = 0; v < sources.size(); ++v) {
    frames.push_back(FramesOf(plan.at("videos")[v], sources[v]));
    n_frames += frames.back().size();
    const bool interlaced = plan.at("videos")[v].at("interlaced").get<bool>();
    missing.merge(WriteFrames(sources[v].video, sources[v].info, interlaced, options.size, frames.back(), FramesFolder(folder)));
  }
  if (n_frames - missing.size() < static_cast<size_t>(input::kMinPhotos)) {
    throw base::InputError(videos.front(), fmt::format("only {} of {} frames can be decoded", n_frames - missing.size(), n_frames),
                           "Copy the video from the card again");
  }
  if (!missing.empty()) {
    base::LogWarning("{} of {} chosen frames are left out, because they cannot be decoded; {} lists them", missing.size(), n_frames,
                     (folder / kTableName).string());
    plan["left_out"] = missing;
    base::WriteFileAtomically(folder / kPlanName, base::JsonText(plan, 1) + "\n");
  }
  base::WriteFileAtomically(folder / kTableName, TableOf(plan, sources, frames, missing));
  base::LogInfo("{} frames are in {}; {} says why each was chosen", n_frames - missing.size(), FramesFolder(folder).string(),
                (folder / kTableName).string());
}

}  // namespace skyquilt::prepare::video
