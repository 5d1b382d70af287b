#include "worker/fall_guard.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

constexpr double kSwingFollows = 0.05;
constexpr int kFirstWindows = 24;  // whose swing is always learned; later, that of windows that are worse than the best might be a slow fall
constexpr double kMostUp = 0.25, kMostUpSwings = 4.0;
constexpr double kMostSwings = 10.0;  // a window and the best of hundreds, both of a field that swings slowly
// A window that is this many swings worse than the best, which is the luckiest of many, is still good.
constexpr double kGoodSwings = 1.5;

}  // namespace

bool FallGuard::Worse(const Window& window, double factor) const {
  return window.mean > factor * state_.best.mean && window.mean - state_.best.mean > kSigmas * std::hypot(window.error, state_.best.error) &&
         std::log(window.mean / state_.best.mean) > kMostSwings * std::sqrt(state_.swing);
}

void FallGuard::LearnSwing(double mean) {
  if (!(mean > 0.0)) return;
  if (state_.previous > 0.0) {
    // Steps up only: a training that gets better fast does not swing. Of noise, every other step is one, so their mean square is its variance.
    // Cut off, so that the beginning of a fall does not hide the rest of it.
    const double most = state_.windows < kFirstWindows ? kMostUp : std::min(kMostUp, kMostUpSwings * std::sqrt(state_.swing) + 1e-3);
    const double up = std::clamp(std::log(mean / state_.previous), 0.0, most);
    const double follow = std::max(kSwingFollows, 1.0 / ++state_.windows);
    state_.swing += follow * (up * up - state_.swing);
  }
  state_.previous = mean;
}

FallGuard::Verdict FallGuard::Add(int64_t step, double mean_squared_error, double saturated) {
  State& s = state_;
  s.sum += mean_squared_error;
  s.squares += mean_squared_error * mean_squared_error;
  s.saturated += saturated;
  ++s.count;
  if (step % kWindow != 0) return Verdict::kNone;
  const double n = s.count, mean = s.sum / n;
  const Window window{mean, std::sqrt(std::max(0.0, s.squares / n - mean * mean) / std::max(1.0, n - 1.0))};
  const bool dense = s.saturated / n > kMostSaturated;
  const bool whole = s.count == kWindow;
  s.sum = s.squares = s.saturated = 0.0;
  s.count = 0;
  if (!whole || step < kFirstStep) return Verdict::kNone;
  state_.last = window;
  const bool bad = Worse(window, dense ? kGoodFactor : kBadFactor);
  state_.bad_in_a_row = bad ? state_.bad_in_a_row + 1 : 0;
  if (state_.bad_in_a_row >= kBadInARow || Worse(window, kWorstFactor)) return Verdict::kFallen;
  if (bad) return Verdict::kBad;
  if (state_.windows < kFirstWindows || !Worse(window, kEndFactor)) LearnSwing(window.mean);
  if (window.mean < state_.best.mean) state_.best = window;
  const double good = std::max(kGoodFactor, std::exp(kGoodSwings * std::sqrt(state_.swing)));
  return window.mean <= good * state_.best.mean ? Verdict::kGood : Verdict::kBad;
}

bool FallGuard::EndsFallen() const {
  return std::isfinite(state_.best.mean) && (state_.bad_in_a_row > 0 || Worse(state_.last, kEndFactor));
}

}  // namespace skyquilt::worker
