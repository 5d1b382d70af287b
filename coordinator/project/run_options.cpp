#include "coordinator/project/run_options.h"

#include "core/base/system.h"

namespace skyquilt::coordinator {

std::vector<config::Field<RunOptions>> RunOptions::Fields() {
  using config::Range;
  using O = RunOptions;
  return {
      {"image_width", &O::image_width, Range{16, 65536}.Or(0), "pixels; photos are reduced to this width for training and scoring; 0: full size"},
      {"time_budget_s", &O::time_budget_s, Range{0, 1e8},
       "seconds for all training together, divided between context and blocks; 0: the steps of [context] and [train] decide"},
      {"context_share", &O::context_share, Range{0.01, 0.9}, "share of the time budget that the context gets"},
      {"seed", &O::seed, Range::AtLeast(0), "start of every random sequence of the training"},
      {"threads", &O::threads, Range{0, 4096}, "threads per machine; 0: every core this process may use"},
      {"memory_gb", &O::memory_gb, Range{0, 1e6},
       "memory per machine that fields and photos may take, in GiB, divided among the ranks on it; 0: half of the machine. Training refuses to start "
       "with blocks that do not fit, and reads photos' pixels on demand when they do not; rendering loads blocks on demand"},
  };
}

int RunOptions::UsableThreads() const {
  return threads > 0 ? threads : base::UsableCores();
}

double RunOptions::MemoryLimitBytes() const {
  return memory_gb > 0.0 ? memory_gb * 1073741824.0 : 0.5 * static_cast<double>(base::TotalMemoryBytes());
}

void RunOptions::Check() const {
  config::CheckRanges("run", *this);
}

}  // namespace skyquilt::coordinator
