#include "coordinator/scheduler/expected_steps.h"

#include <algorithm>
#include <limits>

namespace skyquilt::coordinator {
namespace {

// Training samples per second and thread. docs/benchmarks.md has 2.11 M/s for the town and 2.45 M/s for Seneca on two threads with AVX-512
// (`scripts/demo.sh` with SKYQUILT_DEMO_BUDGET=5min, and `skyquilt train --time-budget 10min`); AVX2 has 0.82 of that (`skyquilt bench kernel --isa
// avx2`), and neighbours on the host take some.
constexpr double kSamplesPerThread = 0.8e6;
// Gradients go into one level's table per thread, of 8 by default: more threads help a field less.
constexpr int kMostThreads = 8;

}  // namespace

double ExpectedBlockSteps(const Settings& settings, int ranks, int local_ranks) {
  const RunOptions& run = settings.run;
  if (!(run.time_budget_s > 0.0)) return std::numeric_limits<double>::infinity();
  const int workers = std::max(1, ranks - 1);
  const int threads = std::clamp(run.UsableThreads() / std::max(1, local_ranks), 1, kMostThreads);
  const double samples = run.time_budget_s * (1.0 - run.context_share) * workers * threads * kSamplesPerThread;
  return samples / settings.train.batch_samples;
}

}  // namespace skyquilt::coordinator
