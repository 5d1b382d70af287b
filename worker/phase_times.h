// Where the time of a training step goes: seconds of work per phase, summed over threads.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <vector>

namespace skyquilt::worker {

enum class Phase { kDraw, kEncode, kDensity, kColor, kContext, kCompose, kBackward, kScatter, kOptimise, kOccupancy };
constexpr size_t kPhases = 10;
constexpr std::array<const char*, kPhases> kPhaseNames = {"draw rays", "hash forward",     "density network", "colour network", "context",
                                                          "compose",   "network backward", "hash backward",   "optimiser",      "occupancy"};

class PhaseTimes {
 public:
  using Clock = std::chrono::steady_clock;

  explicit PhaseTimes(int n_threads) : slots_(static_cast<size_t>(n_threads)) {}

  // Adds the time since `from` to a thread's account and returns now.
  Clock::time_point Add(int thread, Phase phase, Clock::time_point from) {
    const Clock::time_point now = Clock::now();
    slots_[static_cast<size_t>(thread)].seconds[static_cast<size_t>(phase)] += std::chrono::duration<double>(now - from).count();
    return now;
  }
  std::array<double, kPhases> Seconds() const {
    std::array<double, kPhases> sum = {};
    for (const Slot& slot : slots_) {
      for (size_t i = 0; i < kPhases; ++i) sum[i] += slot.seconds[i];
    }
    return sum;
  }
  void Clear() { slots_.assign(slots_.size(), Slot{}); }

 private:
  struct alignas(64) Slot {  // a cache line or two per thread, never shared
    std::array<double, kPhases> seconds = {};
  };
  std::vector<Slot> slots_;
};

}  // namespace skyquilt::worker
