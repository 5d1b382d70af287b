// Shows the progress of long work in one line: bar, percentage, rate, elapsed and remaining time, and a free text.
// On a terminal the line is redrawn in place; in a file a new line is written about every 8 s. Nothing is shown when quiet. Thread-safe.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace skyquilt::base {

class Progress {
 public:
  // `unit` is shown with the rate ("photos", "rays"). total <= 0: unknown, then a count is shown instead of bar and percentage. done_before: done by
  // an earlier run that this one continues; it counts in the bar, not in the rate.
  Progress(const std::string& label, double total, const std::string& unit, double done_before = 0.0);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // `done` counts from 0 to the total. An empty `detail` keeps the text shown before.
  void Update(double done, const std::string& detail = "");
  void Advance(double by = 1.0, const std::string& detail = "");
  // Draws the final state and ends the line; later calls do nothing.
  void Finish(const std::string& detail = "");

  static void SetQuiet(bool quiet);
  // Called with the label and the share that is done (0 to 1) of every progress whose total is known, also when quiet: at its end, and between at
  // most some times a second. On the thread that reports the progress, one call at a time; it must not report progress itself. Empty: nobody listens.
  static void SetListener(std::function<void(const std::string& label, double share)> listener);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Erases the progress line on a terminal, so that other output to standard error starts on an empty line; the next update draws it again.
void ClearProgressLine();

}  // namespace skyquilt::base
