// Options that concern the whole way from photos to report, [run] in the configuration.
#pragma once

#include <vector>

#include "core/config/options.h"

namespace skyquilt::coordinator {

struct RunOptions {
  int image_width = 1000;       // pixels; photos are reduced to it for training and scoring; 0: full size
  double time_budget_s = 0.0;   // of the whole training; 0: the steps of [context] and [train] decide
  double context_share = 0.15;  // of the time budget
  int seed = 1;
  int threads = 0;         // per machine; 0: every core this process may use
  double memory_gb = 0.0;  // per machine; 0: half of it

  // Of this machine, for all its ranks together.
  int UsableThreads() const;
  double MemoryLimitBytes() const;

  static std::vector<config::Field<RunOptions>> Fields();
  // Throws base::UsageError naming the option, its value and what is allowed.
  void Check() const;
};

}  // namespace skyquilt::coordinator
