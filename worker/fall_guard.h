// Watches the training error of a field for falls. A training can fall apart with finite numbers: its error rises within some dozens of steps far
// above what it was, and nothing else shows it.
// The steps are divided into windows. A window is bad when its mean error exceeds the smallest mean of an earlier window by a factor, by more than
// the noise of both, and by more than windows differ anyway: photos whose water glints differently in each make a training swing for as long as it
// lasts. Enough bad windows in a row are a fall. No clock and no state beside State, so that a resumed training judges as it would have.
#pragma once

#include <cstdint>
#include <limits>

namespace skyquilt::worker {

// A training that fell apart and was taken back.
struct Fall {
  int64_t step = 0;           // at which it was noticed
  double best_psnr_db = 0.0;  // of a window before
  double psnr_db = 0.0;       // of the window that showed it
  int64_t restored_step = 0;  // of the state that it was taken back to
};

class FallGuard {
 public:
  static constexpr int kWindow = 32;                 // steps
  static constexpr int64_t kFirstStep = 256;         // earlier, nothing is judged: surfaces are not found yet
  static constexpr double kBadFactor = 1.2589254;    // 1 dB
  static constexpr double kWorstFactor = 1.9952623;  // 3 dB: one window is enough
  static constexpr int kBadInARow = 2;
  static constexpr double kGoodFactor = 1.0592537;  // 0.25 dB
  static constexpr double kEndFactor = 1.0964782;   // 0.4 dB: most that a field may end above its best
  static constexpr double kSigmas = 5.0;            // of the difference of two windows
  // Share of the samples that light reaches which are far denser than opaque. While space fills with them, a window is bad that is not good. Alone
  // they mean nothing: hard surfaces are as dense.
  static constexpr double kMostSaturated = 0.25;

  // A window's mean squared error and the standard error of that mean.
  struct Window {
    double mean = std::numeric_limits<double>::infinity();
    double error = 0.0;
  };
  // Part of the checkpoint.
  struct State {
    Window best, last;
    int bad_in_a_row = 0;
    // How much windows swing: variance of the logarithm of their means, from how many of them, and the mean of the last of these.
    double swing = 0.0;
    int windows = 0;
    double previous = 0.0;
    // Sums over the steps of the present window so far.
    double sum = 0.0, squares = 0.0, saturated = 0.0;
    int count = 0;
  };
  enum class Verdict {
    kNone,    // within a window, or too early
    kGood,    // as good as ever: worth keeping
    kBad,     // not good, not yet a fall
    kFallen,  // go back
  };

  // Of the step with this number, 1 for the first. mean_squared_error: of its rays. saturated: share of its samples, 0..1.
  Verdict Add(int64_t step, double mean_squared_error, double saturated);
  // Whether the training, which ends now, must not end as it is: the last window is worse than the best by kEndFactor and by more than noise.
  bool EndsFallen() const;
  const State& state() const { return state_; }
  void SetState(const State& state) { state_ = state; }

 private:
  // Whether a window is worse than the best by this factor and by more than noise and swing.
  bool Worse(const Window& window, double factor) const;
  // Learns from a window that is not bad how much windows differ.
  void LearnSwing(double mean);

  State state_;
};

}  // namespace skyquilt::worker
