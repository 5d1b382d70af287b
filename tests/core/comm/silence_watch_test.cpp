#include "core/comm/silence_watch.h"

#include <gtest/gtest.h>

namespace skyquilt::comm {
namespace {

using What = SilenceWatch::What;

struct Found {
  double at_s = 0.0;
  int rank = 0;
  What what = What::kSilent;
  bool operator==(const Found&) const = default;
};

// All ranks but `silent` are heard every second; returns what was found, until a rank is lost.
std::vector<Found> Watch(SilenceWatch& watch, int ranks, double from_s, double to_s, int silent, double limit_s) {
  std::vector<Found> all;
  for (double now_s = from_s; now_s < to_s; now_s += 1.0) {
    for (int rank = 0; rank < ranks; ++rank) {
      if (rank != silent) watch.Heard(rank, now_s);
    }
    for (const SilenceWatch::Finding& one : watch.Check(now_s, limit_s)) {
      all.push_back({now_s, one.rank, one.what});
      if (one.what == What::kLost) return all;
    }
  }
  return all;
}

TEST(SilenceWatch, NamesASilentRankOnceThenLosesIt) {
  SilenceWatch watch(4);
  EXPECT_TRUE(Watch(watch, 4, 1000.0, 1100.0, -1, 60.0).empty());
  EXPECT_EQ(Watch(watch, 4, 1100.0, 1200.0, 2, 60.0), (std::vector<Found>{{1115.0, 2, What::kSilent}, {1160.0, 2, What::kLost}}));
}

TEST(SilenceWatch, ARankThatComesBackIsSaid) {
  SilenceWatch watch(3);
  EXPECT_EQ(Watch(watch, 3, 0.0, 40.0, 1, 60.0), (std::vector<Found>{{16.0, 1, What::kSilent}}));
  EXPECT_EQ(Watch(watch, 3, 40.0, 80.0, -1, 60.0), (std::vector<Found>{{40.0, 1, What::kBack}}));
  EXPECT_EQ(Watch(watch, 3, 80.0, 100.0, 1, 60.0), (std::vector<Found>{{95.0, 1, What::kSilent}}));
}

TEST(SilenceWatch, ARankThatWasNeverHeardCountsFromTheBeginning) {
  SilenceWatch watch(2);
  EXPECT_EQ(Watch(watch, 2, 5000.0, 5100.0, 1, 20.0), (std::vector<Found>{{5006.0, 1, What::kSilent}, {5021.0, 1, What::kLost}}));
}

// A laptop that slept: the others could not be heard, and are not judged by that time.
TEST(SilenceWatch, APauseOfItsOwnJudgesNobody) {
  SilenceWatch watch(3);
  Watch(watch, 3, 0.0, 10.0, -1, 60.0);
  EXPECT_TRUE(watch.Check(500.0, 60.0).empty());
  EXPECT_EQ(Watch(watch, 3, 501.0, 600.0, 2, 60.0), (std::vector<Found>{{516.0, 2, What::kSilent}, {561.0, 2, What::kLost}}));
}

TEST(SilenceWatch, WithoutALimitNothingIsFound) {
  SilenceWatch watch(2);
  EXPECT_TRUE(Watch(watch, 2, 0.0, 1000.0, 1, 0.0).empty());
}

}  // namespace
}  // namespace skyquilt::comm
