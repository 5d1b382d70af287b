// Saves what an evaluation has found out about the photos so far, so that it continues from there after it was killed or interrupted.
#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "evaluate/evaluate_input.h"
#include "evaluate/metrics/summary.h"
#include "evaluate/page/written_pictures.h"
#include "evaluate/progress_file.h"
#include "evaluate/surface/photo_errors.h"

namespace skyquilt::evaluate {

// When to save: every so many seconds of work, and so seldom that saving takes less than a twentieth of the time. Times in seconds since any moment.
class SaveSchedule {
 public:
  SaveSchedule(double every_s, double begin_s) : every_s_(every_s), last_s_(begin_s) {}
  bool Due(double now_s) const;
  // Saving took from begin_s to end_s.
  void Saved(double begin_s, double end_s);

 private:
  double every_s_;
  double last_s_;
  double took_s_ = 0.0;
};

// What grows with every photo. All have the same number of photos whenever it is saved.
struct ScoreState {
  metrics::Scores* scores = nullptr;
  surface::SurfacePhotoErrors* surface = nullptr;  // null: no surface is scored
  page::WrittenPictures* pictures = nullptr;
};

class ScoreSaver {
 public:
  // held_out: the photos in the order in which they are scored. input and what state points to must outlive it. Does nothing when
  // input.progress_file is empty.
  ScoreSaver(const EvaluateInput& input, const std::vector<int>& held_out, ScoreState state);

  // Fills the state, which must be as before the first photo, with what an earlier evaluation of the same inputs saved, and says so in the log.
  // Otherwise, also when pictures that it wrote are missing, leaves it as it is.
  void Resume();
  // Call after every photo. A file that cannot be written is no error: the log says it once.
  void SaveWhenDue();
  void Save();
  // Call when the evaluation is complete.
  void Remove() const;
  // Spent on this evaluation before it was interrupted.
  double earlier_s() const { return earlier_s_; }

 private:
  void Load(base::ByteUnpacker* in);
  double Now() const;  // seconds since the construction

  const EvaluateInput& input_;
  const size_t n_photos_;
  const ScoreState state_;
  const ProgressFile file_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  SaveSchedule schedule_;
  double earlier_s_ = 0.0;
  size_t n_bytes_ = 0;  // of the last saving
  bool warned_ = false;
};

}  // namespace skyquilt::evaluate
