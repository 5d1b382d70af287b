#include "evaluate/train_log.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/base/file.h"
#include "core/base/log.h"

namespace skyquilt::evaluate {

namespace {

using Json = nlohmann::json;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double Number(const Json& json, const char* key, double fallback) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : fallback;
}

int64_t Integer(const Json& json, const char* key) {
  return static_cast<int64_t>(std::llround(Number(json, key, 0.0)));
}

std::string Text(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::vector<std::string> SplitLine(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    cell.erase(0, std::min(cell.find_first_not_of(" \t\r"), cell.size()));
    cell.erase(cell.find_last_not_of(" \t\r") + 1);
    cells.push_back(cell);
  }
  return cells;
}

double ParseNumber(const std::string& text) {
  double value = kUnknown;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() ? value : kUnknown;
}

}  // namespace

const FieldLog* TrainLog::Find(const std::string& name) const {
  const auto match = std::find_if(fields.begin(), fields.end(), [&](const FieldLog& field) { return field.name == name; });
  return match == fields.end() ? nullptr : &*match;
}

double TrainLog::TrainSeconds() const {
  double field_seconds = 0.0;
  for (const FieldLog& field : fields) field_seconds += field.seconds;
  const double seconds = std::max(wall_seconds, field_seconds / std::max(ranks, 1));
  return seconds > 0.0 ? seconds : kUnknown;
}

double TrainLog::SamplesPerRay() const {
  int64_t samples = 0, rays = 0;
  for (const FieldLog& field : fields) {
    samples += field.samples;
    rays += field.rays;
  }
  return rays > 0 ? static_cast<double>(samples) / static_cast<double>(rays) : kUnknown;
}

double TrainLog::SamplesPerSecond() const {
  int64_t samples = 0;
  for (const FieldLog& field : fields) samples += field.samples;
  const double seconds = TrainSeconds();
  return samples > 0 && seconds > 0.0 ? static_cast<double>(samples) / seconds : kUnknown;
}

std::vector<CurvePoint> ParseCurve(const std::string& csv) {
  std::istringstream stream(csv);
  std::string line;
  if (!std::getline(stream, line)) return {};
  const std::vector<std::string> header = SplitLine(line);
  const auto column_of = [&](const char* name) {
    return static_cast<size_t>(std::distance(header.begin(), std::find(header.begin(), header.end(), name)));
  };
  const size_t step = column_of("step"), seconds = column_of("seconds"), loss = column_of("loss"), psnr = column_of("psnr");
  std::vector<CurvePoint> curve;
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = SplitLine(line);
    if (cells.size() < header.size()) continue;
    const auto cell = [&](size_t column) { return column < cells.size() ? ParseNumber(cells[column]) : kUnknown; };
    const CurvePoint point{cell(step), cell(seconds), cell(loss), cell(psnr)};
    if (std::isfinite(point.step) || std::isfinite(point.seconds)) curve.push_back(point);
  }
  return curve;
}

TrainLog ReadTrainLog(const std::filesystem::path& train_json, const std::filesystem::path& checkpoint_folder) {
  TrainLog log;
  std::error_code ignored;
  if (train_json.empty() || !std::filesystem::is_regular_file(train_json, ignored)) return log;
  const Json json = Json::parse(base::ReadFile(train_json), nullptr, false);
  if (!json.is_object()) {
    spdlog::warn("{}: not valid JSON; the report goes without training figures. Run `skyquilt train` again to rewrite it", train_json.string());
    return log;
  }
  log.found = true;
  log.ranks = static_cast<int>(Integer(json, "ranks"));
  log.threads = static_cast<int>(Integer(json, "threads"));
  log.wall_seconds = Number(json, "wall_seconds", 0.0);
  log.peak_rss_bytes = Integer(json, "peak_rss_bytes");
  const auto fields = json.find("fields");
  if (fields == json.end() || !fields->is_array()) return log;
  for (const Json& entry : *fields) {
    if (!entry.is_object()) continue;
    FieldLog field;
    field.name = Text(entry, "name");
    const auto ok = entry.find("ok");
    field.ok = ok != entry.end() && ok->is_boolean() && ok->get<bool>();
    field.reason = Text(entry, "reason");
    field.steps = Integer(entry, "steps");
    field.seconds = Number(entry, "seconds", 0.0);
    field.samples = Integer(entry, "samples");
    field.rays = Integer(entry, "rays");
    field.parameters = Integer(entry, "parameters");
    field.psnr_db = Number(entry, "psnr_db", kUnknown);
    field.dropped_steps = Integer(entry, "dropped_steps");
    if (const auto stages = entry.find("stage_seconds"); stages != entry.end() && stages->is_object()) {
      for (const auto& [stage, seconds] : stages->items()) {
        if (seconds.is_number()) field.stage_seconds.emplace_back(stage, seconds.get<double>());
      }
    }
    for (const std::string& stem : {field.name, "block_" + field.name}) {
      const std::filesystem::path csv = checkpoint_folder / (stem + ".log.csv");
      if (!std::filesystem::is_regular_file(csv, ignored)) continue;
      field.curve = ParseCurve(base::ReadFile(csv));
      break;
    }
    log.fields.push_back(std::move(field));
  }
  return log;
}

}  // namespace skyquilt::evaluate
