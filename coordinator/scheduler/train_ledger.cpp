#include "coordinator/scheduler/train_ledger.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;

}  // namespace

TrainLedger::TrainLedger(const Project& project, const std::string& config_hash) : project_(project), config_hash_(config_hash) {
  if (!std::filesystem::exists(project.TrainLedgerFile())) return;
  try {
    const json ledger = base::ParseJson(base::ReadFile(project.TrainLedgerFile()));
    if (ledger.at("config_hash") != config_hash) return;
    spent_s_ = ledger.at("spent_s").get<double>();
    promised_s_ = ledger.at("promised_s").get<std::map<std::string, double>>();
    outcomes_ = ledger.at("outcomes").get<std::map<std::string, std::string>>();
  } catch (const json::exception& error) {
    // Only the division of the time budget depends on this file; checkpoints do not.
    base::LogWarning("{}: is damaged ({}). Checkpoints are kept and training continues, but with the full time budget again",
                     project.TrainLedgerFile().string(), error.what());
    spent_s_ = 0.0;
    promised_s_.clear();
    outcomes_.clear();
  }
}

double TrainLedger::AssignedSeconds(const std::string& field) const {
  const auto found = promised_s_.find(field);
  return found == promised_s_.end() ? 0.0 : found->second;
}

void TrainLedger::AssignSeconds(const std::string& field, double seconds) {
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
  // A field that was already complete was only loaded: keep the time and memory measured when it was trained.
  if (previous != outcomes_.end() && !outcome.failure) {
    const FieldOutcome earlier = OutcomeFromText(previous->second);
    if (!earlier.failure && earlier.job.attempt >= outcome.job.attempt && earlier.result.steps >= outcome.result.steps) return;
  }
  outcomes_[outcome.job.name] = ToText(outcome);
  Save();
}

std::optional<FieldOutcome> TrainLedger::OutcomeOf(const std::string& field) const {
  const auto found = outcomes_.find(field);
  return found == outcomes_.end() ? std::nullopt : std::optional(OutcomeFromText(found->second));
}

void TrainLedger::Save() const {
  std::filesystem::create_directories(project_.StateFolder());
  const json ledger = {{"config_hash", config_hash_}, {"spent_s", spent_s_}, {"promised_s", promised_s_}, {"outcomes", outcomes_}};
  base::WriteFileAtomically(project_.TrainLedgerFile(), base::JsonText(ledger, 1) + "\n");
}

scene::TrainReport TrainLedger::Report(int ranks, int threads) const {
  scene::TrainReport report{.ranks = ranks, .threads = threads, .wall_seconds = spent_s_, .config_hash = config_hash_, .fields = {}};
  for (const auto& [name, text] : outcomes_) {
    const FieldOutcome outcome = OutcomeFromText(text);
    const worker::TrainResult& r = outcome.result;
    scene::FieldTraining field;
    // Outside the scheduler a block has no "block_" in front of its name.
    field.name = outcome.job.block < 0 ? outcome.job.name : outcome.job.name.substr(outcome.job.name.find('_') + 1);
    field.block = outcome.job.block;
    field.ok = !outcome.failure;
    field.reason = outcome.failure.Text();
    field.steps = r.steps;
    field.seconds = r.seconds;
    field.wall_seconds = outcome.wall_s;
    field.samples = r.samples;
    field.rays = r.rays;
    field.parameters = r.parameters;
    field.psnr_db = r.final_psnr_db;
    field.dropped_steps = r.dropped_steps;
    for (const worker::Fall& fall : r.falls) field.falls.push_back({fall.step, fall.best_psnr_db, fall.psnr_db, fall.restored_step});
    field.ended_early = r.ended_early;
    field.shows_context = r.ShowsContext();
    if (r.comparison) {
      field.block_psnr_db = r.comparison->block_psnr_db;
      field.context_psnr_db = r.comparison->context_psnr_db;
    }
    field.attempts = outcome.job.attempt + 1;
    field.rank = outcome.rank;
    field.threads = outcome.threads;
    field.peak_rss_bytes = outcome.peak_rss_bytes;
    for (size_t i = 0; i < worker::kPhases; ++i) field.phase_seconds[worker::kPhaseNames[i]] = r.phase_seconds[i];
    report.fields.push_back(std::move(field));
  }
  std::sort(report.fields.begin(), report.fields.end(), [](const auto& a, const auto& b) { return a.block < b.block; });
  return report;
}

}  // namespace skyquilt::coordinator
