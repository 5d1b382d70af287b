// Measures how long the phases of a training step take: working time per phase in seconds, summed over threads.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <vector>

namespace skyquilt::worker {

enum class Phase { kDraw, kEncode, kDensity, kColor, kContext, kCompose, kBackward, kScatter, kOptimise, kOccupancy, kSampler };
constexpr size_t kPhases = 11;
constexpr std::array<const char*, kPhases> kPhaseNames = {"draw rays", "hash forward", "density network",  "colour network",
                                                          "context",   "compose",      "network backward", "hash backward",
                                                          "optimiser", "occupancy",    "sampler passes"};

class PhaseTimes {
 public:
  using Clock = std::chrono::steady_clock;

  explicit PhaseTimes(int n_threads) : slots_(static_cast<size_t>(n_threads)) {}

  // Adds the time since `from` to a phase of a thread and returns the current time.
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
  struct alignas(64) Slot {  // cache lines of its own for every thread
    std::array<double, kPhases> seconds = {};
  };
  std::vector<Slot> slots_;
};

}  // namespace skyquilt::worker
