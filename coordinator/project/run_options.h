// Options that concern all stages from photos to report: section [run] of the configuration.
#pragma once

#include <vector>

#include "core/config/options.h"

namespace skyquilt::coordinator {

// run.image_width: chosen when the blocks are made (planning/paying_width.h), at least the other.
constexpr int kAutoWidth = -1, kLeastAutoWidth = 1000;

struct RunOptions {
  int image_width = 1000;         // pixels; photos are scaled down to this width for training and scoring; 0: full size
  double time_budget_s = 0.0;     // seconds for the whole training; 0: the steps of [context] and [train] decide
  double within_s = 0.0;          // seconds for all of 'skyquilt run'; 0: the stages take as long as they take
  double context_share = 0.15;    // fraction of the time budget, 0..1
  double shortest_block_s = 2.0;  // seconds that a block trains even when that exceeds the time budget
  double rank_timeout_s = 120.0;  // seconds for which a rank may stand still before the job ends; 0: for ever
  int seed = 1;
  int threads = 0;         // per machine; 0: every core this process may use
  double memory_gb = 0.0;  // per machine; 0: half of it

  // Not options:
  double memory_share = 1.0;           // of the limit, for one of several scenes in the same process
  bool budget_has_everything = false;  // decoding and set-up count in the time budget too; set where the total of the run is given

  // For all ranks on this machine together.
  int UsableThreads() const;
  double MemoryLimitBytes() const;

  static std::vector<config::Field<RunOptions>> Fields();
  // Throws base::UsageError naming the option, its value and the allowed range.
  void Check() const;
};

}  // namespace skyquilt::coordinator
