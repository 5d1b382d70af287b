#include "coordinator/scheduler/train_ledger.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;

std::filesystem::path LedgerFile(const Project& project) {
  return project.StateFolder() / "training.json";
}

}  // namespace

TrainLedger::TrainLedger(const Project& project, const std::string& config_hash) : project_(project), config_hash_(config_hash) {
  if (!std::filesystem::exists(LedgerFile(project))) return;
  try {
    const json ledger = json::parse(base::ReadFile(LedgerFile(project)));
    if (ledger.at("config_hash") != config_hash) return;
    spent_s_ = ledger.at("spent_s").get<double>();
    promised_s_ = ledger.at("promised_s").get<std::map<std::string, double>>();
    outcomes_ = ledger.at("outcomes").get<std::map<std::string, std::string>>();
  } catch (const json::exception& error) {
    // Only the sharing of the rest of the budget depends on it, never the result in steps.
    spdlog::warn("{}: damaged ({}); the time budget starts anew", LedgerFile(project).string(), error.what());
    spent_s_ = 0.0;
    promised_s_.clear();
    outcomes_.clear();
  }
}

double TrainLedger::Promised(const std::string& field) const {
  const auto found = promised_s_.find(field);
  return found == promised_s_.end() ? 0.0 : found->second;
}

void TrainLedger::Promise(const std::string& field, double seconds) {
  promised_s_[field] = seconds;
  Save();
}

void TrainLedger::SetSpent(double seconds, bool now) {
  spent_s_ = seconds;
  if (!now && seconds - saved_at_s_ < 5.0) return;
  saved_at_s_ = seconds;
  Save();
}

void TrainLedger::AddOutcome(const FieldOutcome& outcome) {
  const auto previous = outcomes_.find(outcome.job.name);
  // A field that was complete already says nothing new about time and memory: the earlier figures stand.
  if (previous != outcomes_.end() && outcome.failure == Failure::kNone) {
    const FieldOutcome earlier = OutcomeFromText(previous->second);
    if (earlier.failure == Failure::kNone && earlier.result.steps >= outcome.result.steps) return;
  }
  outcomes_[outcome.job.name] = ToText(outcome);
  Save();
}

void TrainLedger::Save() const {
  std::filesystem::create_directories(project_.StateFolder());
  const json ledger = {{"config_hash", config_hash_}, {"spent_s", spent_s_}, {"promised_s", promised_s_}, {"outcomes", outcomes_}};
  base::WriteFileAtomically(LedgerFile(project_), ledger.dump(1) + "\n");
}

void TrainLedger::WriteReport(int ranks, int threads) const {
  json fields = json::array();
  int64_t peak = 0;
  int64_t samples = 0;
  int64_t parameters = 0;
  std::vector<FieldOutcome> outcomes;
  for (const auto& [name, text] : outcomes_) outcomes.push_back(OutcomeFromText(text));
  std::sort(outcomes.begin(), outcomes.end(), [](const FieldOutcome& a, const FieldOutcome& b) { return a.job.block < b.job.block; });
  for (const FieldOutcome& outcome : outcomes) {
    const worker::TrainResult& r = outcome.result;
    peak = std::max(peak, outcome.peak_rss_bytes);
    samples += r.samples;
    parameters += r.parameters;
    // By the block's own name, as everywhere outside the scheduler.
    const std::string name = outcome.job.block < 0 ? outcome.job.name : outcome.job.name.substr(outcome.job.name.find('_') + 1);
    json stages = json::object();
    for (size_t i = 0; i < worker::kStages; ++i) stages[worker::kStageNames[i]] = r.stage_seconds[i];
    fields.push_back({{"name", name},
                      {"block", outcome.job.block},
                      {"ok", outcome.failure == Failure::kNone},
                      {"reason", outcome.reason},
                      {"steps", r.steps},
                      {"seconds", r.seconds},
                      {"wall_seconds", outcome.wall_s},
                      {"samples", r.samples},
                      {"rays", r.rays},
                      {"parameters", r.parameters},
                      {"psnr_db", r.final_psnr_db},
                      {"dropped_steps", r.dropped_steps},
                      {"attempts", outcome.job.attempt + 1},
                      {"rank", outcome.rank},
                      {"threads", outcome.threads},
                      {"peak_rss_bytes", outcome.peak_rss_bytes},
                      {"stage_seconds", stages}});
  }
  const json report = {{"ranks", ranks},     {"threads", threads},       {"wall_seconds", spent_s_},    {"peak_rss_bytes", peak},
                       {"samples", samples}, {"parameters", parameters}, {"config_hash", config_hash_}, {"fields", fields}};
  base::WriteFileAtomically(project_.TrainReport(), report.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

}  // namespace skyquilt::coordinator
