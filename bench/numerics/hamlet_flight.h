// A small simulated survey for cases that need the whole pipeline: the hamlet in one block, a fixed number of steps.
#pragma once

#include <algorithm>

#include "bench/numerics/groups.h"
#include "coordinator/stages/pipeline.h"
#include "core/base/log.h"
#include "core/base/progress.h"

namespace skyquilt::bench {

struct HamletTraining {
  int seed = 1;
  int context_steps = 100, train_steps = 200;  // of 8192 samples
};
coordinator::Settings HamletSettings(const HamletTraining& training, const NumericsOptions& options);

// While it exists, only warnings and errors are logged, and no progress is shown. For cases that run the whole pipeline.
class QuietStages {
 public:
  // always: keep progress hidden afterwards too.
  explicit QuietStages(bool always) : always_(always), level_(base::GetLogLevel()) {
    base::SetLogLevel(std::max(level_, base::LogLevel::kWarning));
    base::Progress::SetQuiet(true);
  }
  ~QuietStages() {
    base::SetLogLevel(level_);
    base::Progress::SetQuiet(always_);
  }
  QuietStages(const QuietStages&) = delete;
  QuietStages& operator=(const QuietStages&) = delete;

 private:
  bool always_;
  base::LogLevel level_;
};

}  // namespace skyquilt::bench
