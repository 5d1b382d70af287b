// The state of a training besides its checkpoints, so that a resumed training keeps the same time budget: seconds used, seconds assigned to each
// field, and the results of finished fields. Kept in .state/training.json.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/scheduler/field_job.h"
#include "core/scene/train_report.h"

namespace skyquilt::coordinator {

class TrainLedger {
 public:
  // Reads the state of an earlier run if it has the same configuration; a damaged file is ignored with a warning.
  TrainLedger(const Project& project, const std::string& config_hash);

  double spent_s() const { return spent_s_; }
  // Seconds assigned to a field ("context" or "block_<name>"); 0 when none were assigned yet.
  double AssignedSeconds(const std::string& field) const;
  void AssignSeconds(const std::string& field, double seconds);
  // Wall seconds of training so far, earlier runs included. Written to disk at most every 5 s, or at once with `now`.
  void SetSpent(double seconds, bool now);

  void AddOutcome(const FieldOutcome& outcome);
  // Of a field that has one; nothing for others.
  std::optional<FieldOutcome> OutcomeOf(const std::string& field) const;
  // The results of every field so far, the context first. threads: of each rank that trains.
  scene::TrainReport Report(int ranks, int threads) const;

 private:
  void Save() const;

  Project project_;
  std::string config_hash_;
  double spent_s_ = 0.0;
  double saved_at_s_ = -1e9;
  std::map<std::string, double> promised_s_;
  std::map<std::string, std::string> outcomes_;  // by field name, as text
};

}  // namespace skyquilt::coordinator
