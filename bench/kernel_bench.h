// Measures how fast a field trains on this machine, and compares it with a limit (roofline) that is measured in the same run:
//   limit in seconds per sample and thread = network operations / peak rate + sum over levels of 8 (random read + random addition)
// All parts of the limit are measured on all threads at once. Sample positions are random, which is the worst case for caches.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/sampler_speed.h"
#include "worker/phase_times.h"

namespace skyquilt::bench {

struct KernelBenchOptions {
  std::string isa;  // empty: the best of this processor
  int threads = 0;  // 0: every usable core
  int levels = 16;
  int features = 2;
  int log2_table_size = 19;
  int hidden = 64;
  int color_hidden_layers = 2;
  int sh_degree = 4;
  int64_t batch_samples = 262144;
  int samples_per_ray = 16;
  double seconds = 2.0;  // of one measurement
  int rounds = 3;        // medians of these

  // Throws base::UsageError naming the option.
  void Check() const;
};

// Medians over rounds at one number of threads.
struct KernelSpeed {
  int threads = 1;
  double train_samples_per_second = 0.0;
  double infer_samples_per_second = 0.0;
  double roofline_train_samples_per_second = 0.0;  // the limit, for all threads together
  double roofline_infer_samples_per_second = 0.0;
  double gflops_per_thread = 0.0;
  double network_limit_s = 0.0;  // per sample and thread
  double gather_limit_s = 0.0;
  double scatter_limit_s = 0.0;
  std::array<double, worker::kPhases> train_share = {};  // fraction of the threads' time in each phase of a training step
  double waiting_share = 0.0;                            // fraction of the threads' time that is in no phase
  double RooflineFraction() const { return train_samples_per_second / roofline_train_samples_per_second; }
};

struct KernelBenchResult {
  KernelBenchOptions options;
  std::string isa;
  KernelSpeed all;                      // options.threads
  std::vector<KernelSpeed> one_thread;  // one entry when threads > 1: for the scaling
  double train_flops = 0.0;             // per sample
  std::vector<SamplerSpeed> samplers;   // on all threads, of a field of this size
  // Speed-up by threads divided by the speed-up of the limit; 1 when only one thread is used.
  double ScalingFraction() const;
};

// Shows progress; minutes at most. Throws base::Interrupted when cancelled.
KernelBenchResult RunKernelBench(const KernelBenchOptions& options);

// JSON for scripts, and a table for the terminal.
std::string KernelBenchJson(const KernelBenchResult& result);
std::string KernelBenchTable(const KernelBenchResult& result);
// command: the command line. Values that were not measured are shown as an en dash.
BenchPage KernelBenchPage(const KernelBenchResult& result, const std::string& command);

}  // namespace skyquilt::bench
