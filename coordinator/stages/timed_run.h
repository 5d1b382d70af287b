// `run --within`: keeps the time of all stages together. Before each stage it plans what is left, with what the stages before really took, and
// decides how much of the stage is made; training gets what the predicted later stages leave. Every decision is in the log, in plan.json and in the
// report. Decisions change options, as if the user had given them, and are kept in the project (coordinator/planning/run_ledger.h): the same command
// goes on with those of the stages that have begun.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/planning/needs.h"
#include "coordinator/planning/plan.h"
#include "coordinator/planning/predictor.h"
#include "coordinator/planning/run_ledger.h"
#include "coordinator/stages/pipeline.h"
#include "evaluate/metrics/run_times.h"

namespace skyquilt::coordinator {

class TimedRun {
 public:
  // For a pipeline with run.within_s > 0. Changes its settings to those that earlier runs have decided, so call it before they are compared with
  // results. Forgets all of that when pipeline.restart is set.
  explicit TimedRun(Pipeline& pipeline, RunLedger::Clock clock = SystemClock());

  // From here on time passes. Counts the photos, measures the machine, and logs the first plan. Throws base::UsageError and base::InputError when
  // memory or disk cannot be enough, base::InputError without photos.
  void Start(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model);
  // Before a stage is looked at: decides its options, once.
  void Decide(Pipeline& pipeline, const std::string& stage);
  // Around a stage that is made.
  void Began(const std::string& stage);
  void Ended(Pipeline& pipeline, const std::string& stage);
  // The stage that runs gave something up by itself.
  void GaveUp(const std::string& stage, const std::string& what, const std::string& text);

  // What was planned and used so far.
  evaluate::metrics::RunTimes Times() const;
  double UsedSeconds() const { return ledger_.UsedSeconds(); }

  static RunLedger::Clock SystemClock();

 private:
  bool IsDecided(const Pipeline& pipeline, const std::string& stage) const;
  bool IsDone(const Pipeline& pipeline, const std::string& stage) const;
  // From `first` on, without what is done.
  std::vector<std::string> Remaining(const Pipeline& pipeline, const std::string& first) const;
  Plan PlanFrom(const Pipeline& pipeline, const std::string& first) const;
  void ApplyTo(Pipeline& pipeline, const std::vector<config::Override>& changes) const;
  void LookAtProject(Pipeline& pipeline, const std::string& stage);
  void TakeTrainingSpeed(const scene::TrainReport& training);
  void CheckRoom(const Pipeline& pipeline) const;
  void WritePlan(const Pipeline& pipeline) const;

  RunLedger ledger_;
  double within_s_;
  bool training_is_given_;  // by the user: its time or its steps
  bool rays_measured_ = false;
  Predictor predictor_;
};

// Where the settings ask for a total time: makes pipeline.timed, which RunStages follows. Call it before results are compared with the settings.
void UseTotalTime(Pipeline& pipeline);

// The plan with which a run of these photos would begin, for `skyquilt plan`: no project is needed. predictor: counts and rates.
Plan PlanOfNewRun(const Predictor& predictor, const Settings& settings, double within_s, const Room& room);

}  // namespace skyquilt::coordinator
