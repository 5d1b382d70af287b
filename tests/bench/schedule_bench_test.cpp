#include "bench/schedule_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/base/errors.h"
#include "core/base/progress.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

class ScheduleBench : public testing::Test {
 protected:
  void SetUp() override {
    base::Progress::SetQuiet(true);
    options_.blocks = 300;
    options_.ranks = 31;
    options_.status_every_s = 5.0;
  }
  void TearDown() override { base::Progress::SetQuiet(false); }
  ScheduleBenchOptions options_;
};

TEST_F(ScheduleBench, EqualRanksWithEqualBlocksAreNeverIdle) {
  options_.cost_spread = options_.cost_error = options_.speed_spread = options_.stragglers = options_.failing = 0.0;
  const ScheduleBenchResult result = RunScheduleBench(options_);
  EXPECT_NEAR(result.work_s, 300 * options_.block_seconds, 1e-6 * result.work_s);
  EXPECT_NEAR(result.undisturbed.wall_s, 10 * options_.block_seconds, 1.0);
  EXPECT_NEAR(result.undisturbed.efficiency, 30.0 / 31.0, 1e-3);
  EXPECT_EQ(result.undisturbed.moves, 0);
  EXPECT_EQ(result.failing.restarts, 0);
  EXPECT_EQ(result.failing.wall_s, result.undisturbed.wall_s);
}

TEST_F(ScheduleBench, ASlowRankDoesNotDelayTheOthers) {
  options_.speed_spread = 0.0;
  options_.stragglers = 0.1;
  options_.failing = 0.0;
  options_.cost_spread = 0.8;
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    options_.seed = seed;
    const ScheduleBenchResult result = RunScheduleBench(options_);
    const ScheduleRun& run = result.undisturbed;
    // Lower bounds: the longest block, and the total work divided among all ranks, of which about a tenth has half the speed.
    EXPECT_LT(run.wall_s, 1.15 * std::max(result.longest_s, result.work_s / (0.95 * 30.0))) << seed;
    EXPECT_GT(run.moves, 0) << seed;
  }
}

TEST_F(ScheduleBench, LostRanksCauseRestartsAndLoseNoBlock) {
  options_.failing = 0.1;
  const ScheduleBenchResult result = RunScheduleBench(options_);
  EXPECT_EQ(result.failing.restarts, 3);
  EXPECT_GT(result.failing.wall_s, result.undisturbed.wall_s + 2 * options_.restart_s);
  // A loss costs the restart, at most one checkpoint interval of all ranks' work, and less balance at the end.
  EXPECT_LT(result.failing.wall_s, result.undisturbed.wall_s + 3 * (options_.restart_s + options_.checkpoint_every_s) + options_.block_seconds);
}

TEST_F(ScheduleBench, ReadsMeasuredBlocks) {
  const TemporaryFolder folder;
  std::ofstream(folder / "train.json") << R"({"fields": [{"block": -1, "ok": true, "seconds": 9}, {"block": 0, "ok": true, "seconds": 30},
                                              {"block": 1, "ok": false, "seconds": 1}, {"block": 2, "ok": true, "seconds": 60}]})";
  EXPECT_EQ(MeasuredBlockSeconds(folder / "train.json"), (std::vector<double>{30.0, 60.0}));
  std::ofstream(folder / "other.json") << "[1]";
  EXPECT_THROW(MeasuredBlockSeconds(folder / "other.json"), base::InputError);
}

TEST_F(ScheduleBench, RefusesInvalidOptions) {
  options_.ranks = 1;
  EXPECT_THROW(RunScheduleBench(options_), base::UsageError);
  options_.ranks = 2;
  options_.failing = 1.5;
  EXPECT_THROW(RunScheduleBench(options_), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::bench
