#include "evaluate/metrics/run_times.h"

#include <gtest/gtest.h>

namespace skyquilt::evaluate::metrics {
namespace {

TEST(HasTimeToScore, UntilOneMoreWouldEndTooLate) {
  const RunTimes times{.within_s = 300.0, .scored_until_s = 288.0, .used_s = 200.0, .stages = {}, .given_up = {}, .scores_given_up = {}};
  EXPECT_TRUE(HasTimeToScore(times, 4, 4, 40.0));  // each takes 10 s: the next until 250 s
  EXPECT_TRUE(HasTimeToScore(times, 8, 8, 78.0));
  EXPECT_FALSE(HasTimeToScore(times, 8, 8, 79.0));
  EXPECT_TRUE(HasTimeToScore(times, 6, 0, 80.0));  // how long one takes here is not known yet
  EXPECT_FALSE(HasTimeToScore(times, 6, 0, 89.0));
}

TEST(HasTimeToScore, TwoPhotosAlways) {
  const RunTimes times{.within_s = 10.0, .scored_until_s = 9.6, .used_s = 50.0, .stages = {}, .given_up = {}, .scores_given_up = {}};
  EXPECT_TRUE(HasTimeToScore(times, 0, 0, 0.0));
  EXPECT_TRUE(HasTimeToScore(times, 1, 1, 30.0));
  EXPECT_FALSE(HasTimeToScore(times, 2, 2, 60.0));
}

}  // namespace
}  // namespace skyquilt::evaluate::metrics
