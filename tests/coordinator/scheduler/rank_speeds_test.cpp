#include "coordinator/scheduler/rank_speeds.h"

#include <gtest/gtest.h>

namespace skyquilt::coordinator {
namespace {

// Ranks 1 and 2 have each trained a block of cost 100 in 100 s; rank 3 is training a block of the same cost at a third of the speed.
RankSpeeds ThreeRanks(double slow_fraction, double now_s) {
  RankSpeeds speeds;
  for (const int rank : {1, 2}) {
    speeds.Started(rank, 100.0, 0.0);
    speeds.Progress(rank, 0.0, 0.0);
    speeds.Finished(rank, 100.0);
  }
  speeds.Started(3, 100.0, 0.0);
  speeds.Progress(3, 0.0, 0.0);
  speeds.Progress(3, slow_fraction, now_s);
  return speeds;
}

TEST(RankSpeeds, MeasuresFinishedBlocks) {
  const RankSpeeds speeds = ThreeRanks(0.3, 100.0);
  EXPECT_DOUBLE_EQ(speeds.Speed(1), 1.0);
  EXPECT_DOUBLE_EQ(speeds.Speed(7), 1.0);  // new: the mean of the others
  EXPECT_DOUBLE_EQ(RankSpeeds().Speed(1), 0.0);
}

TEST(RankSpeeds, FindsARankThatWouldFinishLast) {
  EXPECT_EQ(ThreeRanks(0.3, 100.0).SlowRank(1, 0.0, 3, 100.0), 3);
}

TEST(RankSpeeds, DoesNotMoveABlockThatEndsBeforeTheOthers) {
  // Ten more blocks wait for three ranks, so the slow rank has enough time.
  EXPECT_EQ(ThreeRanks(0.3, 100.0).SlowRank(1, 1000.0, 3, 100.0), std::nullopt);
}

TEST(RankSpeeds, DoesNotMoveABlockWhenThatSavesNoTime) {
  EXPECT_EQ(ThreeRanks(0.9, 100.0).SlowRank(1, 0.0, 3, 100.0), std::nullopt);  // eleven seconds left
  EXPECT_EQ(ThreeRanks(0.01, 10.0).SlowRank(1, 0.0, 3, 10.0), std::nullopt);   // too early to judge
  EXPECT_EQ(RankSpeeds().SlowRank(1, 0.0, 3, 100.0), std::nullopt);            // no rank has finished anything
}

TEST(RankSpeeds, AsksForABlockOnce) {
  RankSpeeds speeds = ThreeRanks(0.3, 100.0);
  speeds.Keep(3);
  EXPECT_EQ(speeds.SlowRank(1, 0.0, 3, 100.0), std::nullopt);
}

TEST(RankSpeeds, ARankThatHasStoppedIsSlow) {
  EXPECT_EQ(ThreeRanks(0.0, 0.0).SlowRank(1, 0.0, 3, 100.0), 3);
}

TEST(RankSpeeds, BlocksFinishedInEarlierRunsDoNotCount) {
  RankSpeeds speeds;
  speeds.Started(1, 100.0, 0.0);
  speeds.Finished(1, 0.1);
  EXPECT_DOUBLE_EQ(speeds.Speed(1), 0.0);
}

}  // namespace
}  // namespace skyquilt::coordinator
