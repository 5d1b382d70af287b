#include "coordinator/scheduler/field_job.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/base/system.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;

json JobToJson(const FieldJob& job) {
  return {{"block", job.block},     {"name", job.name},        {"attempt", job.attempt}, {"steps", job.steps},
          {"seconds", job.seconds}, {"rate", job.rate_factor}, {"seed", job.seed}};
}

FieldJob JobFromJson(const json& j) {
  FieldJob job;
  job.block = j.at("block").get<int>();
  job.name = j.at("name").get<std::string>();
  job.attempt = j.at("attempt").get<int>();
  job.steps = j.at("steps").get<int>();
  job.seconds = j.at("seconds").get<double>();
  job.rate_factor = j.at("rate").get<double>();
  job.seed = j.at("seed").get<uint64_t>();
  return job;
}

// JSON has no NaN: it is sent as null and read as 0.
double Number(const json& j, const char* key) {
  return j.contains(key) && j.at(key).is_number() ? j.at(key).get<double>() : 0.0;
}

// What was found about the training, in objects that the outcome's own text holds.
json FindingsToJson(const worker::TrainResult& r) {
  json falls = json::array();
  for (const worker::Fall& fall : r.falls) falls.push_back({fall.step, fall.best_psnr_db, fall.psnr_db, fall.restored_step});
  json findings = {{"falls", falls}, {"ended_early", r.ended_early}};
  if (r.comparison) findings["comparison"] = {r.comparison->block_psnr_db, r.comparison->context_psnr_db, r.comparison->block_is_worse};
  return findings;
}

double NumberOf(const json& j) {
  return j.is_number() ? j.get<double>() : std::numeric_limits<double>::quiet_NaN();
}

void FindingsFromJson(const json& j, worker::TrainResult& r) {
  for (const json& fall : j.at("falls")) {
    r.falls.push_back({fall.at(0).get<int64_t>(), NumberOf(fall.at(1)), NumberOf(fall.at(2)), fall.at(3).get<int64_t>()});
  }
  r.ended_early = j.at("ended_early").get<bool>();
  if (!j.contains("comparison")) return;
  const json& c = j.at("comparison");
  r.comparison = worker::ContextComparison{NumberOf(c.at(0)), NumberOf(c.at(1)), c.at(2).get<bool>()};
}

}  // namespace

FieldOutcome RunField(const FieldTrainer& trainer, const FieldJob& job, const worker::Reporter& report, int rank, int threads) {
  FieldOutcome outcome;
  outcome.job = job;
  outcome.rank = rank;
  outcome.threads = threads;
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed_s = [&start] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  double trained_s = 0.0;
  const worker::Reporter timed = [&](const worker::TrainStatus& status) {
    trained_s = status.run_seconds;
    if (report) report(status);
  };
  try {
    outcome.result = trainer(job, timed);
    if (!outcome.result.ok) outcome.failure = {Failure::kBlock, outcome.result.reason};
  } catch (...) {
    outcome.failure = CurrentFailure();
  }
  outcome.wall_s = elapsed_s();
  outcome.setup_s = std::max(0.0, outcome.wall_s - trained_s);
  outcome.peak_rss_bytes = base::PeakRssBytes();
  return outcome;
}

std::string ToText(const FieldJob& job) {
  return base::JsonText(JobToJson(job));
}

std::string ToText(const FieldOutcome& outcome) {
  const worker::TrainResult& r = outcome.result;
  const json j = {{"job", JobToJson(outcome.job)},
                  {"failure", ToJson(outcome.failure)},
                  {"rank", outcome.rank},
                  {"threads", outcome.threads},
                  {"wall_s", outcome.wall_s},
                  {"setup_s", outcome.setup_s},
                  {"peak_rss_bytes", outcome.peak_rss_bytes},
                  {"saved_bytes", outcome.saved_bytes},
                  {"ok", r.ok},
                  {"steps", r.steps},
                  {"seconds", r.seconds},
                  {"samples", r.samples},
                  {"rays", r.rays},
                  {"parameters", r.parameters},
                  {"psnr", r.final_psnr_db},
                  {"dropped", r.dropped_steps},
                  {"findings", FindingsToJson(r)},
                  {"phases", r.phase_seconds}};
  return base::JsonText(j);
}

std::string ToText(const worker::TrainStatus& s) {
  const json j = {
      {"step", s.step},    {"total", s.total_steps},    {"fraction", s.fraction},          {"seconds", s.seconds},        {"loss", s.loss},
      {"psnr", s.psnr_db}, {"rays", s.rays_per_second}, {"samples", s.samples_per_second}, {"per_ray", s.samples_per_ray}};
  return base::JsonText(j);
}

FieldJob JobFromText(const std::string& text) {
  return JobFromJson(base::ParseJson(text));
}

FieldOutcome OutcomeFromText(const std::string& text) {
  const json j = base::ParseJson(text);
  FieldOutcome outcome;
  outcome.job = JobFromJson(j.at("job"));
  const json& failure = j.at("failure");
  // Earlier versions stored kind and reason as two separate values.
  outcome.failure =
      failure.is_object() ? FailureFromJson(failure) : Failure{static_cast<Failure::Kind>(failure.get<int>()), j.at("reason").get<std::string>()};
  outcome.rank = j.at("rank").get<int>();
  outcome.threads = j.at("threads").get<int>();
  outcome.wall_s = Number(j, "wall_s");
  outcome.setup_s = Number(j, "setup_s");
  outcome.peak_rss_bytes = j.at("peak_rss_bytes").get<int64_t>();
  outcome.saved_bytes = j.value("saved_bytes", int64_t{-1});
  outcome.result.ok = j.at("ok").get<bool>();
  outcome.result.reason = outcome.failure.reason;
  outcome.result.steps = j.at("steps").get<int64_t>();
  outcome.result.seconds = Number(j, "seconds");
  outcome.result.samples = j.at("samples").get<int64_t>();
  outcome.result.rays = j.at("rays").get<int64_t>();
  outcome.result.parameters = j.at("parameters").get<int64_t>();
  outcome.result.final_psnr_db = Number(j, "psnr");
  outcome.result.dropped_steps = j.at("dropped").get<int>();
  if (j.contains("findings")) FindingsFromJson(j.at("findings"), outcome.result);
  if (j.contains("phases")) outcome.result.phase_seconds = j.at("phases").get<std::array<double, worker::kPhases>>();
  return outcome;
}

worker::TrainStatus StatusFromText(const std::string& text) {
  const json j = base::ParseJson(text);
  worker::TrainStatus s;
  s.step = j.at("step").get<int64_t>();
  s.total_steps = j.at("total").get<int64_t>();
  s.fraction = Number(j, "fraction");
  s.seconds = Number(j, "seconds");
  s.loss = Number(j, "loss");
  s.psnr_db = Number(j, "psnr");
  s.rays_per_second = Number(j, "rays");
  s.samples_per_second = Number(j, "samples");
  s.samples_per_ray = Number(j, "per_ray");
  return s;
}

}  // namespace skyquilt::coordinator
