// Which block is trained next, with how much of the time budget, and what happens when one fails.
// Pure bookkeeping: no clock, no ranks, no files of its own. Not thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "coordinator/scheduler/field_job.h"

namespace skyquilt::coordinator {

struct QueueBlock {
  int block = 0;                  // index into BlockSet::blocks
  std::string name;               // "block_r0c1"
  double cost = 1.0;              // relative share of training time, > 0
  double assigned_seconds = 0.0;  // > 0: handed out by an earlier run with this budget, which is kept
};

struct QueueOptions {
  int steps = 0;              // > 0: every block gets exactly these; the deadline is ignored
  bool has_deadline = false;  // otherwise the time left until the deadline is shared out
  double deadline_s = 0.0;    // on the caller's clock
  double seconds = 0.0;       // without steps and deadline: every block's own budget; 0: the trainer's default
  int n_workers = 1;          // ranks that train at the same time
  int max_tries = 3;
  uint64_t seed = 1;
};

class BlockQueue {
 public:
  BlockQueue(std::vector<QueueBlock> blocks, const QueueOptions& options);

  bool HasWaiting() const { return !waiting_.empty(); }
  // The most expensive waiting block (ties: the lower index). `busy_until_s`: when the ranks now training will be free, on the caller's clock.
  FieldJob Take(double now_s, std::span<const double> busy_until_s);
  // Notes what came of a job. A failed block waits again, with another seed and half the learning rate, until its tries are used up:
  // true when it does.
  bool Record(const FieldOutcome& outcome);
  // Final outcomes in the order they came.
  const std::vector<FieldOutcome>& outcomes() const { return outcomes_; }
  double Cost(int block) const;
  double TotalCost() const { return total_cost_; }
  // Of the blocks that wait.
  double WaitingCost() const;
  // Blocks have fixed work rather than a share of the time, so a faster rank ends them earlier.
  bool FixedWork() const { return options_.steps > 0 || (!options_.has_deadline && options_.seconds <= 0.0); }
  static uint64_t Seed(uint64_t seed, int block, int attempt);

 private:
  struct Waiting {
    QueueBlock block;
    int attempt = 0;
  };
  void Insert(const Waiting& entry);
  // What is left of the time, shared out by cost. Asked again within a five-hundredth of it, the answer stands: it does not change by handing
  // out what it gives, and with ten thousand blocks it takes a while.
  double SecondsPerCost(double now_s, std::span<const double> busy_until_s);

  QueueOptions options_;
  std::vector<QueueBlock> all_;
  std::vector<Waiting> waiting_;  // most expensive first
  std::vector<FieldOutcome> outcomes_;
  double total_cost_ = 0.0;
  double seconds_per_cost_ = 0.0;
  double shared_out_s_ = -1.0;  // when; negative: not yet, or not since the waiting blocks have changed
};

// When the last of n_workers is done if each free one takes the next job in order; `free_at_s` are the ranks' first free moments
// (missing ones: now). Source: list scheduling, Graham 1969.
double ListScheduleEnd(std::span<const double> durations_s, double now_s, std::span<const double> free_at_s, int n_workers);

}  // namespace skyquilt::coordinator
