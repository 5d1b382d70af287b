// The training loop of context and blocks: steps until the budget is used up, with progress reports and checkpoints.
#pragma once

#include <cstdint>
#include <string>

#include "worker/block_session.h"

namespace skyquilt::worker {

class TrainLoop {
 public:
  // kind, extras: as for SaveSession. record: progress of earlier runs. All references must outlive the loop.
  TrainLoop(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer, const ContextBrightness* extras,
            const SessionRecord& record, const Reporter& report);

  // False when too many steps in a row were not finite: the result is then Failure(). Throws base::Interrupted after saving when cancelled,
  // base::InputError when a checkpoint cannot be written.
  bool Run();
  // Saves the field as complete. findings: null for blocks. Throws base::InputError when the checkpoint cannot be written.
  TrainResult SaveResult(const ContextResults* findings);
  TrainResult Failure() const;

 private:
  // Counts since the last report.
  struct Recent {
    double rays = 0.0, samples = 0.0, seconds = 0.0;
  };

  double Fraction() const;  // of the budget used so far
  // One step, with occupancy and counts; false when too many steps in a row were not finite.
  bool Step(double fraction);
  bool RecordError(const StepResult& step);
  void RecordCounts(const StepResult& step);
  void ReportIfDue(double fraction);
  void Report(double fraction);
  void SaveIfDue();
  void MarkUnsampledCells();
  TrainResult Summarise() const;

  std::string kind_;
  const TrainJob& job_;
  render::TrainedField& target_;
  FieldTrainer& trainer_;
  const ContextBrightness* extras_;
  SessionRecord record_;
  const Reporter& report_;
  int64_t total_steps_;  // 0: a time budget decides
  // Times of the last step's end, the last checkpoint and the last report, in seconds of a steady clock.
  double last_ = 0.0, last_save_ = 0.0, last_report_ = 0.0;
  int dropped_in_a_row_ = 0;
  double loss_ = 0.0;  // of the last step
  Recent recent_;
};

}  // namespace skyquilt::worker
