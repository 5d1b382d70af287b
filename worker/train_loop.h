// The training loop of context and blocks: steps until the budget is used up, with progress reports and checkpoints. A training that falls apart
// (fall_guard.h) is taken back to its last good state and goes on with half the learning rate; after three falls it ends there.
#pragma once

#include <cstdint>
#include <string>

#include "worker/block_session.h"
#include "worker/fall_guard.h"
#include "worker/good_state.h"
#include "worker/train_diagnostics.h"

namespace skyquilt::worker {

class TrainLoop {
 public:
  // kind, extras: as for SaveSession. record: progress of earlier runs. All references must outlive the loop.
  TrainLoop(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer, const ContextBrightness* extras,
            const SessionRecord& record, const Reporter& report);

  // False when too many steps in a row were not finite and there is no good state: the result is then Failure(). Throws base::Interrupted after
  // saving when cancelled, base::InputError when a checkpoint cannot be written.
  bool Run();
  // What was found about the finished field; saved with it.
  void SetComparison(const ContextComparison& comparison) { record_.comparison = comparison; }
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
  // Keeps the state or takes it back, as the guard says.
  void Judge(const StepResult& step);
  void RestoreGoodState();
  // After a fall. fell_to: mean squared error that shows it; NaN: values were not finite.
  void TakeBack(double fell_to);
  // Of a training that is over and is worse than it was.
  void EndAtBest();
  std::string Name() const { return kind_ == "context" ? kind_ : "block " + target_.name; }  // for the log
  void RecordCounts(const StepResult& step);
  void ReportIfDue(double fraction);
  void Report(double fraction);
  // Before there is a good state, the present one is saved, with the guard's of now.
  void NoteGuard();
  void Save();
  void SaveIfDue();
  void MarkUnsampledCells();
  TrainResult Summarise() const;

  std::string kind_;
  const TrainJob& job_;
  render::TrainedField& target_;
  FieldTrainer& trainer_;
  const ContextBrightness* extras_;
  SessionRecord record_;
  double seconds_before_ = 0.0;  // of training, in earlier runs
  const Reporter& report_;
  int64_t total_steps_;  // 0: a time budget decides
  // Times of the last step's end, the last checkpoint and the last report, in seconds of a steady clock.
  double last_ = 0.0, last_save_ = 0.0, last_report_ = 0.0;
  int dropped_in_a_row_ = 0;
  FallGuard guard_;
  GoodState good_;
  int64_t saved_step_ = -1;  // of the last checkpoint that this loop wrote
  TrainDiagnostics diagnostics_;
  double loss_ = 0.0;  // of the last step
  Recent recent_;
};

}  // namespace skyquilt::worker
