#include "viewer/engine/batch_size.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::viewer {
namespace {

constexpr double kTargetSeconds = 0.008;
constexpr size_t kFewestRays = 256;
constexpr size_t kMostRays = 16384;
constexpr size_t kRaysPerRank = 2048;  // fewer cost more in messages than in rendering
constexpr size_t kFirstRays = 1024;    // of a thread, before its speed is known
constexpr size_t kSmallestTask = 128;  // rays that one thread takes at a time, at least (scene::PagedRenderer)
constexpr double kWeightOfNewest = 0.3;

}  // namespace

BatchSize::BatchSize(int threads, int remote_ranks) : threads_(std::max(1, threads)), remote_ranks_(static_cast<size_t>(std::max(0, remote_ranks))) {}

size_t BatchSize::rays() const {
  const auto in_target = [&](double speed) { return static_cast<size_t>(std::clamp(speed * kTargetSeconds, 1.0, 1e9)); };
  if (remote_ranks_ > 0) {
    const size_t fewest = kRaysPerRank * remote_ranks_;
    return loading_ ? std::max(fewest, kMostRays) : std::clamp(in_target(speed_), fewest, std::max(fewest, kMostRays));
  }
  // Loading takes much longer than rendering: the more rays share it, the better.
  if (loading_) return kMostRays;
  if (speed_ <= 0.0) return kFirstRays * static_cast<size_t>(std::min(threads_, 4));
  return std::clamp(in_target(speed_ * threads_), kFewestRays, kMostRays);
}

void BatchSize::Add(size_t rays, double seconds, bool loaded_fields) {
  loading_ = loaded_fields;
  // Small batches measure overhead.
  if (loaded_fields || rays < kFewestRays || !(seconds > 0.0) || !std::isfinite(seconds)) return;
  const size_t busy = remote_ranks_ > 0 ? 1 : std::min(static_cast<size_t>(threads_), (rays + kSmallestTask - 1) / kSmallestTask);
  const double measured = static_cast<double>(rays) / static_cast<double>(busy) / seconds;
  speed_ = speed_ > 0.0 ? speed_ + kWeightOfNewest * (measured - speed_) : measured;
}

}  // namespace skyquilt::viewer
