#include "coordinator/scheduler/expected_steps.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace skyquilt::coordinator {
namespace {

Settings Budget(double seconds, int threads) {
  Settings settings;
  settings.run.time_budget_s = seconds;
  settings.run.threads = threads;
  return settings;
}

TEST(ExpectedBlockSteps, AreThoseOfTheTimeThatTheContextLeaves) {
  // 153 s at 2 x 0.8 million samples per second.
  EXPECT_NEAR(ExpectedBlockSteps(Budget(180.0, 2), 1, 1), 153.0 * 1.6e6 / 32768.0, 1e-6);
  Settings small = Budget(180.0, 2);
  small.train.batch_samples /= 4;
  EXPECT_NEAR(ExpectedBlockSteps(small, 1, 1), 4.0 * ExpectedBlockSteps(Budget(180.0, 2), 1, 1), 1e-6);
}

TEST(ExpectedBlockSteps, HaveNoLimitWithoutABudget) {
  Settings settings = Budget(0.0, 2);
  EXPECT_TRUE(std::isinf(ExpectedBlockSteps(settings, 1, 1)));
  settings.train.steps = 300;
  EXPECT_TRUE(std::isinf(ExpectedBlockSteps(settings, 4, 2)));
}

// The first rank trains no block, and ranks of a machine share its threads.
TEST(ExpectedBlockSteps, GrowWithTheRanks) {
  const double alone = ExpectedBlockSteps(Budget(60.0, 8), 1, 1);
  EXPECT_NEAR(ExpectedBlockSteps(Budget(60.0, 8), 5, 1), 4.0 * alone, 1e-6);
  EXPECT_NEAR(ExpectedBlockSteps(Budget(60.0, 8), 5, 4), alone, 1e-6);
  EXPECT_NEAR(ExpectedBlockSteps(Budget(60.0, 64), 1, 1), alone, 1e-6) << "a field has no more use for threads than it has levels";
  EXPECT_GT(ExpectedBlockSteps(Budget(60.0, 1), 64, 64), 0.0);
}

RC_GTEST_PROP(ExpectedBlockSteps, NeverFallWithTheBudget, ()) {
  const double seconds = *rc::gen::inRange(1, 100000), more = seconds + *rc::gen::inRange(0, 100000);
  const int threads = *rc::gen::inRange(1, 256), ranks = *rc::gen::inRange(1, 64), local = *rc::gen::inRange(1, ranks + 1);
  const double steps = ExpectedBlockSteps(Budget(seconds, threads), ranks, local);
  RC_ASSERT(steps > 0.0 && steps <= ExpectedBlockSteps(Budget(more, threads), ranks, local));
}

}  // namespace
}  // namespace skyquilt::coordinator
