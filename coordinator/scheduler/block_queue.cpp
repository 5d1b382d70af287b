#include "coordinator/scheduler/block_queue.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

#include "core/base/errors.h"

namespace skyquilt::coordinator {
namespace {

// A block that is worse than the context after fewer steps has had too few.
constexpr int64_t kStepsToBlameTheRate = 1000;

}  // namespace

double ListScheduleEnd(std::span<const double> durations_s, double now_s, std::span<const double> free_at_s, int n_workers) {
  std::priority_queue<double, std::vector<double>, std::greater<>> free_at;
  for (int i = 0; i < std::max(1, n_workers); ++i) {
    free_at.push(static_cast<size_t>(i) < free_at_s.size() ? std::max(now_s, free_at_s[static_cast<size_t>(i)]) : now_s);
  }
  double end = now_s;
  for (const double duration : durations_s) {
    const double done = free_at.top() + duration;
    free_at.pop();
    free_at.push(done);
    end = std::max(end, done);
  }
  return end;
}

BlockQueue::BlockQueue(std::vector<QueueBlock> blocks, const QueueOptions& options) : options_(options), all_(std::move(blocks)) {
  for (QueueBlock& block : all_) {
    // A block with a cost that is not positive and finite still has to be trained.
    if (!(block.cost > 0.0) || !std::isfinite(block.cost)) block.cost = 1e-6;
    total_cost_ += block.cost;
    Insert({block, 0});
  }
}

void BlockQueue::Insert(const Waiting& entry) {
  const auto position = std::find_if(waiting_.begin(), waiting_.end(), [&entry](const Waiting& other) {
    return entry.block.cost > other.block.cost || (entry.block.cost == other.block.cost && entry.block.block < other.block.block);
  });
  waiting_.insert(position, entry);
  shared_out_s_ = -1.0;
}

double BlockQueue::SecondsPerCost(double now_s, std::span<const double> busy_until_s) {
  if (shared_out_s_ >= 0.0 && now_s - shared_out_s_ < 0.002 * (options_.deadline_s - now_s)) return seconds_per_cost_;
  const auto end = [&](double seconds_per_cost) {
    std::vector<double> durations;
    for (const Waiting& entry : waiting_) {
      durations.push_back(entry.block.assigned_seconds > 0.0 ? entry.block.assigned_seconds : entry.block.cost * seconds_per_cost);
    }
    return ListScheduleEnd(durations, now_s, busy_until_s, options_.n_workers);
  };
  const double left = options_.deadline_s - now_s;
  if (left <= 0.0) return 0.0;
  double low = 0.0;
  double high = left / waiting_.front().block.cost;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (end(middle) <= options_.deadline_s ? low : high) = middle;
  }
  seconds_per_cost_ = low;
  shared_out_s_ = now_s;
  return low;
}

FieldJob BlockQueue::TakeNext(double now_s, std::span<const double> busy_until_s) {
  SKYQUILT_CHECK(!waiting_.empty(), "no block waits");
  const Waiting next = waiting_.front();
  FieldJob job;
  job.block = next.block.block;
  job.name = next.block.name;
  job.attempt = next.attempt;
  job.rate_factor = std::pow(0.5, next.attempt);
  job.seed = Seed(options_.seed, next.block.block, next.attempt);
  if (options_.steps > 0) {
    job.steps = options_.steps;
  } else if (next.block.assigned_seconds > 0.0) {
    job.seconds = next.block.assigned_seconds;
  } else if (options_.has_deadline) {
    job.seconds = std::max(options_.shortest_s, SecondsPerCost(now_s, busy_until_s) * next.block.cost);
  } else {
    job.seconds = options_.seconds;
  }
  waiting_.erase(waiting_.begin());
  return job;
}

bool BlockQueue::DeservesAnotherTry(const FieldOutcome& outcome) const {
  if (outcome.failure.kind == Failure::kBlock) return outcome.job.attempt + 1 < options_.max_tries;
  return outcome.failure.kind == Failure::kNone && outcome.result.ShowsContext() && HasFixedSteps() && outcome.job.attempt == 0 &&
         outcome.result.steps >= kStepsToBlameTheRate;
}

bool BlockQueue::RecordOutcome(const FieldOutcome& outcome) {
  if (DeservesAnotherTry(outcome)) {
    const auto found = std::find_if(all_.begin(), all_.end(), [&outcome](const QueueBlock& block) { return block.block == outcome.job.block; });
    SKYQUILT_CHECK(found != all_.end(), outcome.job.name);
    Waiting again{*found, outcome.job.attempt + 1};
    again.block.assigned_seconds = outcome.job.seconds;
    Insert(again);
    return true;
  }
  outcomes_.push_back(outcome);
  return false;
}

double BlockQueue::Cost(int block) const {
  for (const QueueBlock& entry : all_) {
    if (entry.block == block) return entry.cost;
  }
  return 0.0;
}

double BlockQueue::WaitingCost() const {
  double cost = 0.0;
  for (const Waiting& entry : waiting_) cost += entry.block.cost;
  return cost;
}

uint64_t BlockQueue::Seed(uint64_t seed, int block, int attempt) {
  return seed + 7919ULL * static_cast<uint64_t>(block + 1) + 104729ULL * static_cast<uint64_t>(attempt);
}

}  // namespace skyquilt::coordinator
