#include "worker/fall_guard.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

// Whether `window` is worse than `best` by this factor and by more than noise.
bool Worse(const FallGuard::Window& window, const FallGuard::Window& best, double factor) {
  return window.mean > factor * best.mean && window.mean - best.mean > FallGuard::kSigmas * std::hypot(window.error, best.error);
}

}  // namespace

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
  const bool bad = Worse(window, state_.best, dense ? kGoodFactor : kBadFactor);
  state_.bad_in_a_row = bad ? state_.bad_in_a_row + 1 : 0;
  if (state_.bad_in_a_row >= kBadInARow || Worse(window, state_.best, kWorstFactor)) return Verdict::kFallen;
  if (bad) return Verdict::kBad;
  if (window.mean < state_.best.mean) state_.best = window;
  return window.mean <= kGoodFactor * state_.best.mean ? Verdict::kGood : Verdict::kBad;
}

bool FallGuard::EndsFallen() const {
  return std::isfinite(state_.best.mean) && (state_.bad_in_a_row > 0 || Worse(state_.last, state_.best, kEndFactor));
}

}  // namespace skyquilt::worker
