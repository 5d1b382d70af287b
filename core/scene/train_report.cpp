#include "core/scene/train_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"

namespace skyquilt::scene {
namespace {

using Json = nlohmann::json;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kTrainAgain = "Run 'skyquilt train' again";

int64_t Integer(const Json& json, const char* key, int64_t fallback = 0) {
  const auto found = json.find(key);
  if (found != json.end() && found->is_number_integer()) return found->get<int64_t>();
  return std::llround(base::NumberIn(json, key, static_cast<double>(fallback)));
}

std::string Text(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool Flag(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_boolean() && found->get<bool>();
}

std::vector<FieldFall> FallsFrom(const Json& json) {
  std::vector<FieldFall> falls;
  const auto list = json.find("falls");
  if (list == json.end() || !list->is_array()) return falls;
  for (const Json& fall : *list) {
    if (!fall.is_object()) continue;
    falls.push_back({Integer(fall, "step"), base::NumberIn(fall, "best_psnr_db"), base::NumberIn(fall, "psnr_db"), Integer(fall, "restored_step")});
  }
  return falls;
}

Json FallsToJson(const std::vector<FieldFall>& falls) {
  Json list = Json::array();
  for (const FieldFall& fall : falls) {
    list.push_back({{"step", fall.step}, {"best_psnr_db", fall.best_psnr_db}, {"psnr_db", fall.psnr_db}, {"restored_step", fall.restored_step}});
  }
  return list;
}

FieldTraining FieldFrom(const Json& json) {
  FieldTraining field;
  field.name = Text(json, "name");
  field.block = static_cast<int>(Integer(json, "block", field.name == "context" ? -1 : 0));
  field.ok = Flag(json, "ok");
  field.reason = Text(json, "reason");
  field.steps = Integer(json, "steps");
  field.seconds = base::NumberIn(json, "seconds", 0.0);
  field.wall_seconds = base::NumberIn(json, "wall_seconds", 0.0);
  field.samples = Integer(json, "samples");
  field.rays = Integer(json, "rays");
  field.parameters = Integer(json, "parameters");
  field.psnr_db = base::NumberIn(json, "psnr_db");
  field.dropped_steps = Integer(json, "dropped_steps");
  field.falls = FallsFrom(json);
  field.ended_early = Flag(json, "ended_early");
  field.block_psnr_db = base::NumberIn(json, "block_psnr_db");
  field.context_psnr_db = base::NumberIn(json, "context_psnr_db");
  field.shows_context = Flag(json, "shows_context");
  field.attempts = static_cast<int>(Integer(json, "attempts", 1));
  field.rank = static_cast<int>(Integer(json, "rank"));
  field.threads = static_cast<int>(Integer(json, "threads"));
  field.peak_rss_bytes = Integer(json, "peak_rss_bytes");
  if (const auto phases = json.find("phase_seconds"); phases != json.end() && phases->is_object()) {
    for (const auto& [phase, seconds] : phases->items()) {
      if (seconds.is_number()) field.phase_seconds[phase] = seconds.get<double>();
    }
  }
  return field;
}

Json ToJson(const FieldTraining& field) {
  return {{"name", field.name},
          {"block", field.block},
          {"ok", field.ok},
          {"reason", field.reason},
          {"steps", field.steps},
          {"seconds", field.seconds},
          {"wall_seconds", field.wall_seconds},
          {"samples", field.samples},
          {"rays", field.rays},
          {"parameters", field.parameters},
          {"psnr_db", field.psnr_db},
          {"dropped_steps", field.dropped_steps},
          {"falls", FallsToJson(field.falls)},
          {"ended_early", field.ended_early},
          {"block_psnr_db", field.block_psnr_db},
          {"context_psnr_db", field.context_psnr_db},
          {"shows_context", field.shows_context},
          {"attempts", field.attempts},
          {"rank", field.rank},
          {"threads", field.threads},
          {"peak_rss_bytes", field.peak_rss_bytes},
          {"phase_seconds", field.phase_seconds}};
}

template <typename Member>
int64_t Sum(const std::vector<FieldTraining>& fields, Member member) {
  return std::accumulate(fields.begin(), fields.end(), int64_t{0}, [&](int64_t sum, const FieldTraining& field) { return sum + field.*member; });
}

}  // namespace

const FieldTraining* TrainReport::Find(const std::string& name) const {
  const auto match = std::find_if(fields.begin(), fields.end(), [&](const FieldTraining& field) { return field.name == name; });
  return match == fields.end() ? nullptr : &*match;
}

std::vector<std::string> TrainReport::Failed() const {
  std::vector<std::string> failed;
  for (const FieldTraining& field : fields) {
    if (!field.ok) failed.push_back((field.block < 0 ? "" : "block_") + field.name + ": " + field.reason);
  }
  return failed;
}

int64_t TrainReport::Samples() const {
  return Sum(fields, &FieldTraining::samples);
}

int64_t TrainReport::Parameters() const {
  return Sum(fields, &FieldTraining::parameters);
}

int64_t TrainReport::PeakRssBytes() const {
  int64_t peak = 0;
  for (const FieldTraining& field : fields) peak = std::max(peak, field.peak_rss_bytes);
  return peak;
}

double TrainReport::TrainSeconds() const {
  double field_seconds = 0.0;
  for (const FieldTraining& field : fields) field_seconds += field.seconds;
  const double seconds = std::max(wall_seconds, field_seconds / std::max(ranks, 1));
  return seconds > 0.0 ? seconds : kUnknown;
}

double TrainReport::SamplesPerRay() const {
  const int64_t rays = Sum(fields, &FieldTraining::rays);
  return rays > 0 ? static_cast<double>(Samples()) / static_cast<double>(rays) : kUnknown;
}

double TrainReport::SamplesPerSecond() const {
  const int64_t samples = Samples();
  const double seconds = TrainSeconds();
  return samples > 0 && seconds > 0.0 ? static_cast<double>(samples) / seconds : kUnknown;
}

void WriteTrainReport(const TrainReport& report, const std::filesystem::path& file) {
  Json fields = Json::array();
  for (const FieldTraining& field : report.fields) fields.push_back(ToJson(field));
  const Json json = {{"ranks", report.ranks},
                     {"threads", report.threads},
                     {"wall_seconds", report.wall_seconds},
                     {"peak_rss_bytes", report.PeakRssBytes()},
                     {"samples", report.Samples()},
                     {"parameters", report.Parameters()},
                     {"config_hash", report.config_hash},
                     {"fields", fields}};
  base::WriteFileAtomically(file, base::JsonText(json, 2) + "\n");
}

TrainReport ReadTrainReport(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) throw base::InputError(file, "does not exist", "Run 'skyquilt train' first");
  const Json json = Json::parse(base::ReadFile(file), nullptr, false);
  if (!json.is_object()) throw base::InputError(file, "is damaged: not valid JSON", kTrainAgain);
  const auto fields = json.find("fields");
  if (fields == json.end() || !fields->is_array()) throw base::InputError(file, "is not a training record: it has no list 'fields'", kTrainAgain);
  TrainReport report;
  report.ranks = static_cast<int>(Integer(json, "ranks"));
  report.threads = static_cast<int>(Integer(json, "threads"));
  report.wall_seconds = base::NumberIn(json, "wall_seconds", 0.0);
  report.config_hash = Text(json, "config_hash");
  for (const Json& field : *fields) {
    if (field.is_object()) report.fields.push_back(FieldFrom(field));
  }
  return report;
}

std::optional<TrainReport> TryReadTrainReport(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  try {
    return ReadTrainReport(file);
  } catch (const base::InputError& error) {
    base::LogWarning("{}", error.what());
    return std::nullopt;
  }
}

}  // namespace skyquilt::scene
