// A small simulated survey for cases that need the whole pipeline: the hamlet in one block, a fixed number of steps.
#pragma once

#include "bench/numerics/groups.h"
#include "coordinator/stages/pipeline.h"

namespace skyquilt::bench {

struct HamletTraining {
  int seed = 1;
  int context_steps = 100, train_steps = 200;  // of 8192 samples
};
coordinator::Settings HamletSettings(const HamletTraining& training, const NumericsOptions& options);

}  // namespace skyquilt::bench
