// The loop that fields of both kinds share: steps until the budget is used up, with reports and checkpoints on the way.
#pragma once

#include <cstdint>
#include <string>

#include "worker/block_session.h"

namespace skyquilt::worker {

class TrainLoop {
 public:
  // kind and extras as SaveSession takes them; record: how far an earlier run came. All references must outlive the loop.
  TrainLoop(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer, const ContextExtras* extras,
            const SessionRecord& record, const Reporter& report);

  // False when steps kept failing: the result is then Failure(). Throws base::Interrupted after saving when cancelled, base::InputError for a
  // checkpoint that cannot be written.
  bool Run();
  // Saves the field as complete. findings: of the context, null for blocks. Throws base::InputError.
  TrainResult SaveResult(const ContextFindings* findings);
  TrainResult Failure() const;

 private:
  // What happened since the last report.
  struct Recent {
    double rays = 0.0, samples = 0.0, seconds = 0.0;
  };

  double Fraction() const;
  // One step and its bookkeeping; false when too many failed in a row.
  bool Step(double fraction);
  bool KeepError(const StepResult& step);
  void KeepCounts(const StepResult& step);
  void ReportAtTimes(double fraction);
  void Report(double fraction);
  void SaveAtTimes();
  void ForgetUnseenCells();
  TrainResult Summarise() const;

  std::string kind_;
  const TrainJob& job_;
  render::TrainedField& target_;
  FieldTrainer& trainer_;
  const ContextExtras* extras_;
  SessionRecord record_;
  const Reporter& report_;
  int64_t total_steps_;  // 0: a time budget decides
  // Seconds of a steady clock: when the last step ended, and what else happened when.
  double last_ = 0.0, last_save_ = 0.0, last_report_ = 0.0;
  int dropped_in_a_row_ = 0;
  double loss_ = 0.0;  // of the last step
  Recent recent_;
};

}  // namespace skyquilt::worker
