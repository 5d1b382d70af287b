#include "coordinator/scheduler/coordinate.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "coordinator/ranks/rank_messages.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "fake_ranks.h"
#include "tests/support/error_of.h"

namespace skyquilt::coordinator {
namespace {

struct Played {
  std::vector<FieldOutcome> outcomes;
  std::vector<std::string> order;      // names as handed out
  std::map<std::string, int> rank_of;  // rank that trained it last
  int n_status = 0;
};

QueueBlock Named(int block, double cost) {
  return {block, "block_" + std::to_string(block), cost, 0.0};
}

// Rank 0 coordinates in this thread; every other rank has its own thread.
Played Play(int n_ranks, const std::vector<QueueBlock>& blocks, const FieldTrainer& trainer) {
  FakeNetwork network(n_ranks);
  std::vector<std::thread> ranks;
  for (int rank = 1; rank < n_ranks; ++rank) {
    ranks.emplace_back([&network, &trainer, rank] {
      FakeRank comm(network, rank);
      ServeBlocks(comm, trainer, 1);
    });
  }
  FakeRank comm(network, 0);
  BlockQueue queue(blocks, {.steps = 3});
  Played played;
  const CoordinateHooks hooks{.now_s = [] { return 0.0; },
                              .handed_out =
                                  [&](const FieldJob& job, int rank) {
                                    played.order.push_back(job.name);
                                    played.rank_of[job.name] = rank;
                                  },
                              .status = [&](const FieldJob&, const worker::TrainStatus&) { ++played.n_status; },
                              .finished = [](const FieldOutcome&, bool) {}};
  const auto release = [&] {
    for (int rank = 1; rank < n_ranks; ++rank) comm.Send(rank, kTagDone, "");
    for (std::thread& thread : ranks) thread.join();
  };
  try {
    CoordinateBlocks(comm, queue, trainer, 1, hooks);
  } catch (...) {
    release();
    throw;
  }
  release();
  played.outcomes = queue.outcomes();
  return played;
}

worker::TrainResult Good(const FieldJob& job) {
  worker::TrainResult result;
  result.ok = true;
  result.steps = job.steps;
  return result;
}

class Coordinate : public testing::Test {
 protected:
  void SetUp() override { base::ClearCancel(); }
  void TearDown() override { base::ClearCancel(); }
};

TEST_F(Coordinate, EveryBlockIsTrainedExactlyOnceOnAnyNumberOfRanks) {
  base::Random random(11);
  for (const int n_ranks : {1, 2, 3, 5}) {
    std::vector<QueueBlock> blocks;
    blocks.reserve(9);
    for (int i = 0; i < 9; ++i) blocks.push_back(Named(i, random.Uniform(0.1, 1.0)));
    std::mutex mutex;
    std::map<int, int> times;
    const Played played = Play(n_ranks, blocks, [&](const FieldJob& job, const worker::Reporter& report) {
      report({});
      const std::lock_guard lock(mutex);
      ++times[job.block];
      return Good(job);
    });
    EXPECT_EQ(times.size(), 9U);
    for (const auto& [block, n] : times) EXPECT_EQ(n, 1) << "block " << block << " with " << n_ranks << " ranks";
    EXPECT_EQ(played.outcomes.size(), 9U);
    EXPECT_GE(played.n_status, 1);
    for (size_t i = 1; i < played.order.size(); ++i) {
      const auto cost = [&](const std::string& name) { return blocks[static_cast<size_t>(std::stoi(name.substr(6)))].cost; };
      EXPECT_GE(cost(played.order[i - 1]), cost(played.order[i]));
    }
  }
}

// An error of rank 0 itself, such as a full disk: the other ranks stop and return although they get no more than the end of the training.
TEST_F(Coordinate, AnErrorOfRankZeroStopsTheOthers) {
  FakeNetwork network(3);
  std::vector<std::thread> ranks;
  const FieldTrainer trainer = [](const FieldJob& job, const worker::Reporter& report) {
    for (int step = 0; job.block == 1; ++step) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      report({});
      base::ThrowIfCancelled();
      if (step > 60'000) throw std::logic_error("it trains on");
    }
    return Good(job);
  };
  for (int rank = 1; rank < 3; ++rank) {
    ranks.emplace_back([&network, &trainer, rank] {
      FakeRank comm(network, rank);
      ServeBlocks(comm, trainer, 1);
    });
  }
  FakeRank comm(network, 0);
  BlockQueue queue({Named(0, 1.0), Named(1, 1.0)}, {.steps = 3});
  const CoordinateHooks hooks{
      .now_s = [] { return 0.0; },
      .handed_out = [](const FieldJob&, int) {},
      .status = [](const FieldJob&, const worker::TrainStatus&) {},
      .finished = [](const FieldOutcome&, bool) { throw base::InputError("timings.json", "cannot write", "Free some space"); }};
  EXPECT_THROW(CoordinateBlocks(comm, queue, trainer, 1, hooks), base::InputError);
  for (int rank = 1; rank < 3; ++rank) comm.Send(rank, kTagDone, "");
  for (std::thread& thread : ranks) thread.join();
}

TEST_F(Coordinate, RankZeroTrainsOnlyWhenAlone) {
  const FieldTrainer trainer = [](const FieldJob& job, const worker::Reporter&) { return Good(job); };
  for (const auto& [name, rank] : Play(3, {Named(0, 1.0), Named(1, 1.0), Named(2, 1.0)}, trainer).rank_of) EXPECT_NE(rank, 0) << name;
  for (const auto& [name, rank] : Play(1, {Named(0, 1.0)}, trainer).rank_of) EXPECT_EQ(rank, 0) << name;
}

TEST_F(Coordinate, WithoutBlocksItReturnsAtOnce) {
  const FieldTrainer never = [](const FieldJob&, const worker::Reporter&) -> worker::TrainResult { throw std::logic_error("called"); };
  EXPECT_TRUE(Play(1, {}, never).outcomes.empty());
  EXPECT_TRUE(Play(3, {}, never).outcomes.empty());
}

TEST_F(Coordinate, AFailingBlockDoesNotAffectOthers) {
  for (const int n_ranks : {1, 3}) {
    std::atomic<int> tries = 0;
    const Played played = Play(n_ranks, {Named(0, 1.0), Named(1, 2.0), Named(2, 3.0)}, [&](const FieldJob& job, const worker::Reporter&) {
      if (job.block != 1) return Good(job);
      if (++tries == 2) throw std::runtime_error("an exception is a failure too");
      worker::TrainResult result;
      result.reason = "loss is not finite";
      return result;
    });
    EXPECT_EQ(tries, 3);
    ASSERT_EQ(played.outcomes.size(), 3U);
    for (const FieldOutcome& outcome : played.outcomes) {
      EXPECT_EQ(outcome.failure.kind, outcome.job.block == 1 ? Failure::kBlock : Failure::kNone);
      if (outcome.job.block == 1) {
        EXPECT_EQ(outcome.failure.reason, "loss is not finite");
      }
    }
  }
}

TEST_F(Coordinate, ARetryThatSucceedsCounts) {
  const Played played = Play(2, {Named(0, 1.0)}, [](const FieldJob& job, const worker::Reporter&) {
    if (job.attempt == 0) throw std::runtime_error("first time");
    return Good(job);
  });
  ASSERT_EQ(played.outcomes.size(), 1U);
  EXPECT_EQ(played.outcomes[0].failure.kind, Failure::kNone);
  EXPECT_EQ(played.outcomes[0].job.attempt, 1);
}

TEST_F(Coordinate, BadInputOfAnyRankEndsTheCommandWithItsMessage) {
  for (const int n_ranks : {1, 2, 4}) {
    base::ClearCancel();
    const FieldTrainer trainer = [](const FieldJob& job, const worker::Reporter& report) {
      if (job.block == 2) throw base::InputError("photos/a.jpg", "is cut short", "Copy it again");
      // The other ranks train until rank 0 stops them.
      for (int i = 0; i < 2000; ++i) {
        report({});
        base::ThrowIfCancelled();
        if (job.block != 0) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      return Good(job);
    };
    const auto error = Caught<base::InputError>([&] { Play(n_ranks, {Named(0, n_ranks == 4 ? 3.0 : 0.5), Named(1, 1.0), Named(2, 2.0)}, trainer); });
    ASSERT_TRUE(error) << "nothing thrown with " << n_ranks << " ranks";
    const std::string text = error->what();
    if (n_ranks == 1) {
      EXPECT_EQ(text, "photos/a.jpg: is cut short. Copy it again");
    } else {
      EXPECT_TRUE(text.starts_with("photos/a.jpg: rank ") && text.find(" on node") != std::string::npos) << text;
      EXPECT_NE(text.find(": is cut short. Copy it again"), std::string::npos) << text;
    }
    EXPECT_EQ(error->file(), "photos/a.jpg");
  }
}

TEST_F(Coordinate, AWrongCheckpointIsAUsageError) {
  const FieldTrainer trainer = [](const FieldJob&, const worker::Reporter&) -> worker::TrainResult {
    throw base::UsageError("another configuration");
  };
  EXPECT_THROW(Play(1, {Named(0, 1.0)}, trainer), base::UsageError);
  EXPECT_THROW(Play(2, {Named(0, 1.0)}, trainer), base::UsageError);
}

TEST_F(Coordinate, AnInterruptStopsAllRanksAndHandsOutNoMoreBlocks) {
  for (const int n_ranks : {1, 3}) {
    base::ClearCancel();
    std::atomic<int> begun = 0;
    const FieldTrainer trainer = [&](const FieldJob& job, const worker::Reporter& report) {
      if (++begun == (n_ranks == 1 ? 1 : 2)) base::RequestCancel();
      for (int i = 0; i < 4000; ++i) {
        report({});
        base::ThrowIfCancelled();
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      return Good(job);
    };
    EXPECT_THROW(Play(n_ranks, {Named(0, 1.0), Named(1, 1.0), Named(2, 1.0), Named(3, 1.0)}, trainer), base::Interrupted);
    EXPECT_LE(begun, 2);
  }
}

}  // namespace
}  // namespace skyquilt::coordinator
