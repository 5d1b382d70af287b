// Predicts how well a cluster would be used, without a cluster. The real scheduler (BlockQueue, CoordinateBlocks) works with simulated ranks on a
// simulated clock. Ranks differ in speed, cost estimates are wrong, and some ranks are lost; each loss ends the job, which starts again from its
// checkpoints.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/bench_page.h"

namespace skyquilt::bench {

struct ScheduleBenchOptions {
  int blocks = 10000;
  int ranks = 1000;                      // including rank 0, which does not train
  double block_seconds = 600;            // mean seconds of a block on a rank of speed 1
  double cost_spread = 0.5;              // standard deviation of log(block seconds)
  std::vector<double> measured_seconds;  // instead of cost_spread: block times of a real training, drawn with replacement and scaled to the mean
  double cost_error = 0.2;               // standard deviation of log(estimated cost / true cost)
  double speed_spread = 0.05;            // standard deviation of log(rank speed)
  double stragglers = 0.01;              // fraction of ranks with half the speed
  double failing = 0.01;                 // fraction of ranks that are lost at some moment of the job
  double checkpoint_every_s = 20.0;      // work since the last checkpoint is lost when the job ends
  double restart_s = 30.0;               // from a loss until all ranks train again: waiting, launching, loading
  double skip_s = 0.2;                   // to skip a finished block after a restart
  double move_s = 5.0;                   // to save a slow rank's block, and again to load it on another rank
  double status_every_s = 0.5;           // between two progress reports of a rank
  uint64_t seed = 1;

  // Throws base::UsageError naming the option.
  void Check() const;
  bool operator==(const ScheduleBenchOptions&) const = default;
};

struct ScheduleRun {
  double wall_s = 0.0;      // simulated
  double efficiency = 0.0;  // work / (ranks * wall time), rank 0 included; 0..1 with ranks of mean speed 1
  int restarts = 0;
  int moves = 0;  // blocks taken from slow ranks
  double messages_per_second = 0.0;
  double bytes_per_second = 0.0;
  double coordinator_load = 0.0;  // CPU seconds of rank 0 (and of the simulation) per simulated second
};

struct ScheduleBenchResult {
  ScheduleBenchOptions options;
  double work_s = 0.0;
  double longest_s = 0.0;  // seconds of the longest block at speed 1: no schedule can be shorter
  ScheduleRun undisturbed, failing;
  int64_t coordinator_bytes = 0;  // memory that queue, jobs and simulation added to this process
};

// Shows progress. Throws base::Interrupted when cancelled.
ScheduleBenchResult RunScheduleBench(const ScheduleBenchOptions& options);
// Training seconds of the finished blocks in a project's train.json. Throws base::InputError.
std::vector<double> MeasuredBlockSeconds(const std::string& train_json);

std::string ScheduleBenchJson(const ScheduleBenchResult& result);
std::string ScheduleBenchTable(const ScheduleBenchResult& result);
// command: the command line. The targets (95 % undisturbed, 90 % with lost ranks) are set for the default cluster, so they are checked only when
// all options have their defaults, except measured_seconds, status_every_s and seed.
BenchPage ScheduleBenchPage(const ScheduleBenchResult& result, const std::string& command);

}  // namespace skyquilt::bench
