// How well a cluster would be used: the scheduler's own code (BlockQueue, CoordinateBlocks) run against ranks on a simulated clock, with ranks of
// different speed, wrong estimates of cost, and ranks that are lost (each ends the job, which starts again from its checkpoints).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/bench_page.h"

namespace skyquilt::bench {

struct ScheduleBenchOptions {
  int blocks = 10000;
  int ranks = 1000;                      // rank 0 among them, which does not train
  double block_seconds = 600;            // mean seconds of a block on a rank of speed 1
  double cost_spread = 0.5;              // standard deviation of the logarithm of blocks' seconds
  std::vector<double> measured_seconds;  // instead of that spread: blocks' seconds of a real training, drawn with replacement, scaled to the mean
  double cost_error = 0.2;               // standard deviation of the logarithm of estimated over real cost
  double speed_spread = 0.05;            // of the logarithm of ranks' speeds
  double stragglers = 0.01;              // share of ranks with half the speed
  double failing = 0.01;                 // share of ranks that are lost at some moment of the job
  double checkpoint_every_s = 20.0;      // work since the last one is lost with the job
  double restart_s = 30.0;               // until all ranks train again: waiting, launching, loading
  double skip_s = 0.2;                   // to find that a block is complete already, after a restart
  double move_s = 5.0;                   // to save a slow rank's block, and again to go on with it on another
  double status_every_s = 0.5;
  uint64_t seed = 1;

  // Throws base::UsageError naming the option.
  void Check() const;
  bool operator==(const ScheduleBenchOptions&) const = default;
};

struct ScheduleRun {
  double wall_s = 0.0;      // simulated
  double efficiency = 0.0;  // work over (ranks x wall), rank 0 counted as a rank
  int restarts = 0;
  int moves = 0;  // blocks taken from slow ranks
  double messages_per_second = 0.0;
  double bytes_per_second = 0.0;
  double coordinator_load = 0.0;  // CPU seconds of rank 0 (and of the simulation) per simulated second
};

struct ScheduleBenchResult {
  ScheduleBenchOptions options;
  double work_s = 0.0;
  double longest_s = 0.0;  // the largest block's seconds at speed 1: no schedule ends before
  ScheduleRun undisturbed, failing;
  int64_t coordinator_bytes = 0;  // growth of this process by queue, jobs and simulation together
};

// Shows progress. Throws base::Interrupted when cancelled.
ScheduleBenchResult RunScheduleBench(const ScheduleBenchOptions& options);
// Seconds of the blocks in a project's train.json. Throws base::InputError.
std::vector<double> MeasuredBlockSeconds(const std::string& train_json);

std::string ScheduleBenchJson(const ScheduleBenchResult& result);
std::string ScheduleBenchTable(const ScheduleBenchResult& result);
// `command`: as it was typed. Holds the runs against the targets (95 % undisturbed, 90 % with ranks lost) only on the cluster that they are set for,
// that of the defaults; measured seconds, the seed and how often ranks report may be given.
BenchPage ScheduleBenchPage(const ScheduleBenchResult& result, const std::string& command);

}  // namespace skyquilt::bench
