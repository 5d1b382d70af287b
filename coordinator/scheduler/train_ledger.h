// What one training keeps on disk beside the checkpoints (.state/training.json): how much of the time budget is spent and promised, so that a resumed
// training keeps to the same budget, and the training results of every field.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/scheduler/field_job.h"
#include "core/scene/train_report.h"

namespace skyquilt::coordinator {

class TrainLedger {
 public:
  // Reads an earlier run's figures when they belong to the same configuration.
  TrainLedger(const Project& project, const std::string& config_hash);

  double spent_s() const { return spent_s_; }
  // 0 when nothing was promised yet.
  double Promised(const std::string& field) const;
  void Promise(const std::string& field, double seconds);
  // Wall seconds of this configuration's training so far, earlier runs included; written at most every 5 s unless `now` is set.
  void SetSpent(double seconds, bool now);

  void AddOutcome(const FieldOutcome& outcome);
  // The training results of every field so far, the context first. `threads`: per rank that trains.
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
