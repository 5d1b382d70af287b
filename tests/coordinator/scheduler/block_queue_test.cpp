#include "coordinator/scheduler/block_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/base/random.h"

namespace skyquilt::coordinator {
namespace {

std::vector<QueueBlock> RandomBlocks(base::Random& random, int n) {
  std::vector<QueueBlock> blocks;
  blocks.reserve(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) blocks.push_back({i, "block_" + std::to_string(i), random.Uniform(0.01, 1.0), 0.0});
  return blocks;
}

FieldOutcome Outcome(const FieldJob& job, bool ok) {
  FieldOutcome outcome;
  outcome.job = job;
  outcome.failure.kind = ok ? Failure::kNone : Failure::kBlock;
  outcome.failure.reason = ok ? "" : "diverged";
  return outcome;
}

TEST(BlockQueue, HandsOutEachBlockOnceMostExpensiveFirst) {
  base::Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const int n = static_cast<int>(random.Below(12));
    BlockQueue queue(RandomBlocks(random, n), {.steps = 10});
    std::set<int> seen;
    double last_cost = 2.0;
    while (queue.HasWaiting()) {
      const FieldJob job = queue.TakeNext(0.0, {});
      EXPECT_TRUE(seen.insert(job.block).second) << "block " << job.block << " twice";
      EXPECT_LE(queue.Cost(job.block), last_cost);
      last_cost = queue.Cost(job.block);
      EXPECT_EQ(job.steps, 10);
      EXPECT_FALSE(queue.RecordOutcome(Outcome(job, true)));
    }
    EXPECT_EQ(static_cast<int>(seen.size()), n);
  }
}

TEST(BlockQueue, EqualCostsAreOrderedByIndex) {
  BlockQueue queue({{2, "c", 1.0, 0.0}, {0, "a", 1.0, 0.0}, {1, "b", 1.0, 0.0}}, {.steps = 1});
  EXPECT_EQ(queue.TakeNext(0.0, {}).block, 0);
  EXPECT_EQ(queue.TakeNext(0.0, {}).block, 1);
  EXPECT_EQ(queue.TakeNext(0.0, {}).block, 2);
}

// One that is worse than the context, after enough steps, when its steps are fixed: a time budget would be used up.
TEST(BlockQueue, BlockWorseThanTheContextIsTriedOnceMore) {
  const auto worse = [](const FieldJob& job, int64_t steps) {
    FieldOutcome outcome = Outcome(job, true);
    outcome.result.steps = steps;
    outcome.result.comparison = worker::ContextComparison{15.0, 20.0, true};
    return outcome;
  };
  BlockQueue queue({{0, "a", 1.0, 0.0}}, {.steps = 4000});
  EXPECT_TRUE(queue.RecordOutcome(worse(queue.TakeNext(0.0, {}), 4000)));
  const FieldJob second = queue.TakeNext(0.0, {});
  EXPECT_EQ(second.attempt, 1);
  EXPECT_EQ(second.rate_factor, 0.5);
  EXPECT_FALSE(queue.RecordOutcome(worse(second, 4000)));
  EXPECT_FALSE(queue.HasWaiting());
  BlockQueue few({{0, "a", 1.0, 0.0}}, {.steps = 50});
  EXPECT_FALSE(few.RecordOutcome(worse(few.TakeNext(0.0, {}), 50))) << "it had too few steps";
  BlockQueue timed({{0, "a", 1.0, 0.0}}, {.has_deadline = true, .deadline_s = 60.0});
  EXPECT_FALSE(timed.RecordOutcome(worse(timed.TakeNext(0.0, {}), 4000)));
}

TEST(BlockQueue, FailedBlockIsTriedThreeTimesWithOtherSeedAndHalfTheRate) {
  BlockQueue queue({{0, "a", 1.0, 0.0}}, {.steps = 1, .max_tries = 3, .seed = 5});
  std::set<uint64_t> seeds;
  double rate = 2.0;
  for (int attempt = 0; attempt < 3; ++attempt) {
    ASSERT_TRUE(queue.HasWaiting());
    const FieldJob job = queue.TakeNext(0.0, {});
    EXPECT_EQ(job.attempt, attempt);
    EXPECT_DOUBLE_EQ(job.rate_factor, rate / 2.0);
    rate = job.rate_factor;
    EXPECT_TRUE(seeds.insert(job.seed).second);
    EXPECT_EQ(queue.RecordOutcome(Outcome(job, false)), attempt < 2);
  }
  EXPECT_FALSE(queue.HasWaiting());
  ASSERT_EQ(queue.outcomes().size(), 1U);
  EXPECT_EQ(queue.outcomes().front().failure.kind, Failure::kBlock);
}

TEST(BlockQueue, SeedsDoNotDependOnTheOrderOfHandingOut) {
  BlockQueue one({{0, "a", 1.0, 0.0}, {1, "b", 2.0, 0.0}}, {.steps = 1, .seed = 9});
  BlockQueue two({{1, "b", 1.0, 0.0}, {0, "a", 2.0, 0.0}}, {.steps = 1, .seed = 9});
  const FieldJob first = one.TakeNext(0.0, {});
  two.TakeNext(0.0, {});
  const FieldJob second = two.TakeNext(0.0, {});
  EXPECT_EQ(first.block, second.block);
  EXPECT_EQ(first.seed, second.seed);
}

// Simulates a training: every rank takes the next block as soon as it is free.
double PlayedEnd(BlockQueue& queue, int n_workers, double start_s) {
  std::vector<double> free_at(static_cast<size_t>(n_workers), start_s);
  while (queue.HasWaiting()) {
    const auto next = std::min_element(free_at.begin(), free_at.end());
    std::vector<double> busy;
    for (const double t : free_at) {
      if (t > *next) busy.push_back(t);
    }
    const FieldJob job = queue.TakeNext(*next, busy);
    *next += job.seconds;
    queue.RecordOutcome(Outcome(job, true));
  }
  return *std::max_element(free_at.begin(), free_at.end());
}

TEST(BlockQueue, TimeBudgetIsUsedAndNotExceeded) {
  base::Random random(3);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 1 + static_cast<int>(random.Below(10));
    const int workers = std::min(n, 1 + static_cast<int>(random.Below(4)));
    const double start = random.Uniform(0.0, 100.0);
    const double deadline = start + random.Uniform(200.0, 2000.0);
    BlockQueue queue(RandomBlocks(random, n), {.has_deadline = true, .deadline_s = deadline, .n_workers = workers});
    const double end = PlayedEnd(queue, workers, start);
    EXPECT_LE(end, deadline + 2.0 * n);
    EXPECT_GE(end, start + 0.9 * (deadline - start)) << n << " blocks, " << workers << " workers";
  }
}

TEST(BlockQueue, TimeIsDividedByCost) {
  base::Random random(5);
  BlockQueue queue(RandomBlocks(random, 300), {.has_deadline = true, .deadline_s = 1000.0, .n_workers = 50});
  std::vector<double> busy;
  double per_cost = 0.0;
  for (int i = 0; i < 50; ++i) {
    const FieldJob job = queue.TakeNext(0.001 * i, busy);
    if (i == 0) per_cost = job.seconds / queue.Cost(job.block);
    EXPECT_NEAR(job.seconds, per_cost * queue.Cost(job.block), 1e-6 * job.seconds);
    busy.push_back(0.001 * i + job.seconds);
  }
}

TEST(BlockQueue, UnusedTimeIsGivenToTheOtherBlocks) {
  BlockQueue queue({{0, "a", 1.0, 0.0}, {1, "b", 1.0, 0.0}}, {.has_deadline = true, .deadline_s = 100.0});
  EXPECT_NEAR(queue.TakeNext(0.0, {}).seconds, 50.0, 1e-6);
  EXPECT_NEAR(queue.TakeNext(10.0, {}).seconds, 90.0, 1e-6);
}

TEST(BlockQueue, AssignedTimeIsKept) {
  BlockQueue queue({{0, "a", 1.0, 33.0}, {1, "b", 0.5, 0.0}}, {.has_deadline = true, .deadline_s = 100.0});
  EXPECT_DOUBLE_EQ(queue.TakeNext(0.0, {}).seconds, 33.0);
}

TEST(BlockQueue, BlocksTrainALittleAfterTheDeadline) {
  BlockQueue queue({{0, "a", 1.0, 0.0}}, {.has_deadline = true, .deadline_s = 1.0});
  const FieldJob job = queue.TakeNext(50.0, {});
  EXPECT_GT(job.seconds, 0.0);
  EXPECT_LT(job.seconds, 10.0);
}

TEST(ListSchedule, EndsAsComputedByHand) {
  const std::vector<double> jobs = {5.0, 4.0, 3.0, 3.0};
  EXPECT_DOUBLE_EQ(ListScheduleEnd(jobs, 0.0, {}, 2), 8.0);  // 5+3 and 4+3
  EXPECT_DOUBLE_EQ(ListScheduleEnd(jobs, 10.0, {}, 1), 25.0);
  EXPECT_DOUBLE_EQ(ListScheduleEnd({}, 3.0, {}, 4), 3.0);
  const std::vector<double> busy = {6.0};
  EXPECT_DOUBLE_EQ(ListScheduleEnd(std::vector<double>{2.0}, 0.0, busy, 1), 8.0);
}

}  // namespace
}  // namespace skyquilt::coordinator
