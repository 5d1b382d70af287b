#include "coordinator/project/run_options.h"

#include "core/base/system.h"

namespace skyquilt::coordinator {

std::vector<config::Field<RunOptions>> RunOptions::Fields() {
  using config::Range;
  using O = RunOptions;
  return {
      {"image_width", &O::image_width, Range{16, 65536}.Or(0).OrWord("auto", kAutoWidth),
       "pixels; photos are scaled down to this width for training and scoring; 0: full size; auto: 1000, and more where the time for training is "
       "enough "
       "for more"},
      {"time_budget_s", &O::time_budget_s, Range{0, 1e8},
       "seconds for the whole training, divided between context and blocks; 0: the steps of [context] and [train] decide"},
      {"within_s", &O::within_s, Range{0, 1e8},
       "seconds for all stages of 'skyquilt run' together, from photos to report: training gets what the others leave, and what does not fit is made "
       "smaller or left out; 0: no limit"},
      {"context_share", &O::context_share, Range{0.01, 0.9}, "fraction of the time budget for the context"},
      {"shortest_block_s", &O::shortest_block_s, Range{0.1, 1e6},
       "seconds; every block trains for at least so long, even when many blocks together exceed the time budget"},
      {"rank_timeout_s", &O::rank_timeout_s, Range{1, 1e6}.Or(0),
       "seconds; a rank that gives no sign of life for so long ends the job, which resumes when it is run again; 0: never"},
      {"seed", &O::seed, Range::AtLeast(0), "seed of the random numbers of training"},
      {"threads", &O::threads, Range{0, 4096}, "threads per machine; 0: all cores that this process may use"},
      {"memory_gb", &O::memory_gb, Range{0, 1e6},
       "memory limit per machine for fields and photos, in GiB, divided among its ranks; 0: half of the machine's memory. Training refuses to start "
       "when a block does not fit. Photos, and blocks that are rendered, are read from disk on demand when they do not fit"},
  };
}

int RunOptions::UsableThreads() const {
  return threads > 0 ? threads : base::UsableCores();
}

double RunOptions::MemoryLimitBytes() const {
  return memory_share * (memory_gb > 0.0 ? memory_gb * 1073741824.0 : 0.5 * static_cast<double>(base::TotalMemoryBytes()));
}

void RunOptions::Check() const {
  config::CheckRanges("run", *this);
}

}  // namespace skyquilt::coordinator
