// Decides which block is trained next, with how much of the time budget, and whether a failed block is tried again.
// It has no clock, ranks or files of its own, so that a test can run it. Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "coordinator/scheduler/field_job.h"

namespace skyquilt::coordinator {

struct QueueBlock {
  int block = 0;                  // index into BlockSet::blocks
  std::string name;               // "block_r0c1"
  double cost = 1.0;              // expected training time relative to the other blocks, > 0
  double assigned_seconds = 0.0;  // > 0: time budget assigned in an earlier, interrupted run; it is kept
};

struct QueueOptions {
  int steps = 0;              // > 0: every block gets exactly this many; the deadline is ignored
  bool has_deadline = false;  // with steps = 0: the time left until the deadline is divided among the blocks
  double deadline_s = 0.0;    // on the caller's clock
  double shortest_s = 2.0;    // with a deadline: least budget of a block, so that none stays untrained
  double seconds = 0.0;       // without steps and deadline: budget of each block; 0: the trainer's default
  int n_workers = 1;          // ranks that train at the same time
  int max_tries = 3;
  uint64_t seed = 1;
};

class BlockQueue {
 public:
  BlockQueue(std::vector<QueueBlock> blocks, const QueueOptions& options);

  bool HasWaiting() const { return !waiting_.empty(); }
  // Removes and returns the most expensive waiting block (ties: the lower index). At least one block must wait.
  // busy_until_s: when each rank that is training now will be free, on the caller's clock.
  FieldJob TakeNext(double now_s, std::span<const double> busy_until_s);
  // Stores the result of a job. A failed block waits again, with another seed and half the learning rate, until its tries are used up; a block that
  // is worse than the context once, where the number of steps is fixed and was not too small: with a time budget, its time is used up. Returns true
  // when it waits again.
  bool RecordOutcome(const FieldOutcome& outcome);
  // Final outcomes in the order they came.
  const std::vector<FieldOutcome>& outcomes() const { return outcomes_; }
  double Cost(int block) const;
  double TotalCost() const { return total_cost_; }
  // Sum over the waiting blocks.
  double WaitingCost() const;
  // Whether blocks train for a number of steps rather than for a time, so that a faster rank finishes them earlier.
  bool HasFixedSteps() const { return options_.steps > 0 || (!options_.has_deadline && options_.seconds <= 0.0); }
  static uint64_t Seed(uint64_t seed, int block, int attempt);

 private:
  struct Waiting {
    QueueBlock block;
    int attempt = 0;
  };
  void Insert(const Waiting& entry);
  bool DeservesAnotherTry(const FieldOutcome& outcome) const;
  // Time budget per unit of cost such that all waiting blocks end at the deadline. The value is reused until 1/500 of the time left has passed:
  // handing out blocks does not change it, and computing it for ten thousand blocks is slow.
  double SecondsPerCost(double now_s, std::span<const double> busy_until_s);

  QueueOptions options_;
  std::vector<QueueBlock> all_;
  std::vector<Waiting> waiting_;  // most expensive first
  std::vector<FieldOutcome> outcomes_;
  double total_cost_ = 0.0;
  double seconds_per_cost_ = 0.0;
  double shared_out_s_ = -1.0;  // time of the last computation of seconds_per_cost_; negative: none since the waiting blocks changed
};

// End of a schedule in which each worker that becomes free takes the next job in order. free_at_s: when each worker becomes free; workers without
// an entry are free now. Source: list scheduling, Graham 1969.
double ListScheduleEnd(std::span<const double> durations_s, double now_s, std::span<const double> free_at_s, int n_workers);

}  // namespace skyquilt::coordinator
