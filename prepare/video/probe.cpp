#include "prepare/video/probe.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "prepare/video/media_program.h"
#include "prepare/video/track.h"

namespace skyquilt::prepare::video {
namespace {

constexpr int kLargestSide = 65'535;
constexpr const char* kVideoFix =
    "Copy it from the card again. A recording that the drone could not finish (battery empty, card full) has no index: play it on the drone, which "
    "repairs it, or use the program untrunc";

// ffprobe writes most numbers as texts.
std::optional<double> NumberOf(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) return std::nullopt;
  if (found->is_number()) return found->get<double>();
  return found->is_string() ? LeadingNumber(found->get_ref<const std::string&>()) : std::nullopt;
}

std::string TextOf(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// "30000/1001" or "4:3"; 0 for "0/0".
double RatioOf(const std::string& text) {
  size_t length = 0;
  const std::optional<double> over = LeadingNumber(text, &length);
  if (!over || length >= text.size()) return over.value_or(0.0);
  const std::optional<double> under = LeadingNumber(std::string_view(text).substr(length + 1));
  return under && *under > 0.0 && *over > 0.0 ? *over / *under : 0.0;
}

int RotationOf(const nlohmann::json& stream) {
  double degrees = NumberOf(stream.value("tags", nlohmann::json::object()), "rotate").value_or(0.0);
  // The display matrix counts the other way round.
  const auto list = stream.find("side_data_list");
  if (list != stream.end() && list->is_array()) {
    for (const nlohmann::json& data : *list) {
      const std::optional<double> rotation = data.is_object() ? NumberOf(data, "rotation") : std::nullopt;
      if (rotation) degrees = -*rotation;
    }
  }
  if (!(std::abs(degrees) <= 360.0)) return 0;
  return (static_cast<int>(std::lround(degrees / 90.0)) * 90 + 720) % 360;
}

}  // namespace

VideoInfo Probe(const std::filesystem::path& file) {
  std::vector<std::string> arguments = {
      "-v",
      "error",
      "-of",
      "json",
      "-show_entries",
      "stream=codec_type,codec_name,width,height,avg_frame_rate,field_order,duration,sample_aspect_ratio:stream_tags:stream_side_data:"
      "stream_disposition=attached_pic:format=duration,format_name:format_tags"};
  const std::vector<std::string> input = InputArguments(file);
  arguments.insert(arguments.end(), input.begin(), input.end());
  const ProgramOutput said = RunMediaProgram("ffprobe", arguments, file);
  if (!said.ok) {
    const std::string message = LastMessage(said.messages);
    throw base::InputError(file, "cannot be read as a video" + (message.empty() ? "" : " (" + message + ")"), kVideoFix);
  }
  return ParseProbe(said.output, file);
}

VideoInfo ParseProbe(const std::string& json, const std::filesystem::path& file) {
  const nlohmann::json all = base::TryParseJson(json);
  if (!all.is_object()) throw base::InputError(file, "ffprobe says nothing of it", kVideoFix);
  try {
    VideoInfo info;
    const nlohmann::json format = all.value("format", nlohmann::json::object());
    info.duration_s = NumberOf(format, "duration");
    info.has_index = TextOf(format, "format_name").find("mpeg") == std::string::npos;
    std::string created = TextOf(format.value("tags", nlohmann::json::object()), "creation_time");
    for (const nlohmann::json& stream : all.value("streams", nlohmann::json::array())) {
      const std::string type = TextOf(stream, "codec_type");
      info.has_subtitles = info.has_subtitles || type == "subtitle";
      const bool cover = NumberOf(stream.value("disposition", nlohmann::json::object()), "attached_pic").value_or(0.0) != 0.0;
      if (type != "video" || cover || info.width > 0) continue;
      const double width = NumberOf(stream, "width").value_or(0.0), height = NumberOf(stream, "height").value_or(0.0);
      if (!(width >= 1.0 && height >= 1.0 && width <= kLargestSide && height <= kLargestSide)) continue;
      const double shape = RatioOf(TextOf(stream, "sample_aspect_ratio"));
      info.width = static_cast<int>(std::clamp(std::round(width * (shape > 0.01 && shape < 100.0 ? shape : 1.0)), 1.0, double{kLargestSide}));
      info.height = static_cast<int>(height);
      info.rotation_deg = RotationOf(stream);
      if (info.rotation_deg % 180 != 0) std::swap(info.width, info.height);
      if (const std::optional<double> duration_s = NumberOf(stream, "duration")) info.duration_s = duration_s;
      info.frames_per_s = RatioOf(TextOf(stream, "avg_frame_rate"));
      const std::string fields = TextOf(stream, "field_order");
      info.interlaced = fields == "tt" || fields == "bb" || fields == "tb" || fields == "bt";
      info.codec = TextOf(stream, "codec_name");
      if (created.empty()) created = TextOf(stream.value("tags", nlohmann::json::object()), "creation_time");
    }
    if (info.width == 0) throw base::InputError(file, "holds no video that ffmpeg reads", kVideoFix);
    if (info.duration_s && !(*info.duration_s > 0.0)) info.duration_s.reset();
    info.created_clock_s = FindClock(created);
    // What cameras without a clock write.
    constexpr double kYear1980_s = 315'532'800.0;
    if (info.created_clock_s && *info.created_clock_s < kYear1980_s) info.created_clock_s.reset();
    return info;
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("ffprobe's report cannot be used: ") + error.what(), kVideoFix);
  }
}

}  // namespace skyquilt::prepare::video
