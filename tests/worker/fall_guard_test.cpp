// The guard against trainings that fall apart, on made errors.
#include "worker/fall_guard.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <functional>

#include "core/base/random.h"

namespace skyquilt::worker {
namespace {

using Verdict = FallGuard::Verdict;

// The first step at which the guard sees a fall; 0: none.
int64_t FirstFall(FallGuard& guard, int64_t first, int64_t last, const std::function<double(int64_t)>& error, double saturated = 0.0) {
  for (int64_t step = first; step <= last; ++step) {
    if (guard.Add(step, error(step), saturated) == Verdict::kFallen) return step;
  }
  return 0;
}

double Db(double db) {
  return std::pow(10.0, -0.1 * db);
}

// Errors of batches scatter; the fewer rays, the more.
RC_GTEST_PROP(FallGuardTest, NoiseIsNoFall, ()) {
  base::Random random(*rc::gen::arbitrary<uint64_t>(), 1);
  const double scatter = *rc::gen::element(0.02, 0.1, 0.4, 1.0);
  const double gain_db = *rc::gen::element(0.0, 3.0, 10.0);  // of 5000 steps
  FallGuard guard;
  const int64_t fallen = FirstFall(
      guard, 1, 5000, [&](int64_t step) { return Db(20.0 + gain_db * static_cast<double>(step) / 5000.0) * std::exp(scatter * random.Normal()); });
  RC_ASSERT(fallen == 0);
  RC_ASSERT(!guard.EndsFallen());
}

// Where photos contradict each other, the error of the field itself goes up and down, for longer than a window.
TEST(FallGuardTest, SwingsAreNoFall) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    base::Random random(seed, 1);
    double swing = 0.0;
    FallGuard guard;
    const int64_t fallen = FirstFall(guard, 1, 3000, [&](int64_t) {
      swing = 0.95 * swing + 0.03 * random.Normal();
      return Db(15.0) * std::exp(swing + 0.3 * random.Normal());
    });
    EXPECT_EQ(fallen, 0) << seed;
    EXPECT_GT(FirstFall(guard, 3001, 3200, [](int64_t) { return Db(8.0); }), 0) << "a real fall after it, " << seed;
  }
}

TEST(FallGuardTest, AFallIsSeenWithinTwoWindows) {
  base::Random random(3, 1);
  const auto falls_by = [&](double fall_db) {
    FallGuard guard;
    return FirstFall(guard, 1, 3000, [&](int64_t step) { return Db(step > 2000 ? 23.0 - fall_db : 23.0) * std::exp(0.1 * random.Normal()); });
  };
  EXPECT_EQ(falls_by(0.3), 0);
  EXPECT_EQ(falls_by(7.0), 2016) << "the window that begins before the fall shows it";
  EXPECT_GT(falls_by(1.5), 2000);
  EXPECT_LE(falls_by(1.5), 2000 + 3 * FallGuard::kWindow);
}

TEST(FallGuardTest, TheFirstStepsAreNotJudged) {
  FallGuard guard;
  EXPECT_EQ(FirstFall(guard, 1, FallGuard::kFirstStep - 1, [](int64_t step) { return Db(step < 100 ? 30.0 : 10.0); }), 0);
  EXPECT_EQ(FirstFall(guard, FallGuard::kFirstStep, 1000, [](int64_t) { return Db(10.0); }), 0);
}

TEST(FallGuardTest, WithDensityEverywhereASmallerFallIsEnough) {
  const auto error = [](int64_t step) { return Db(step <= 640 ? 20.0 : 19.5); };
  FallGuard solid, filled, hard;
  EXPECT_EQ(FirstFall(solid, 1, 1000, error), 0);
  EXPECT_EQ(FirstFall(filled, 1, 1000, error, 0.9), 704);
  EXPECT_EQ(FirstFall(
                hard, 1, 1000, [](int64_t) { return Db(20.0); }, 0.9),
            0)
      << "density alone means nothing";
}

TEST(FallGuardTest, ATrainingMustNotEndBelowItsBest) {
  FallGuard guard;
  EXPECT_FALSE(guard.EndsFallen()) << "nothing is known yet";
  const auto error = [](double db) { return [db](int64_t step) { return Db(db) * (step % 2 == 0 ? 1.02 : 0.98); }; };
  EXPECT_EQ(FirstFall(guard, 1, 1024, error(24.0)), 0);
  EXPECT_FALSE(guard.EndsFallen());
  EXPECT_EQ(FirstFall(guard, 1025, 1056, error(23.3)), 0);
  EXPECT_TRUE(guard.EndsFallen());
  EXPECT_EQ(FirstFall(guard, 1057, 1088, error(23.9)), 0);
  EXPECT_FALSE(guard.EndsFallen());
}

TEST(FallGuardTest, StatesNearTheBestAreWorthKeeping) {
  FallGuard guard;
  const auto last = [&](int64_t first, int64_t end, double db) {
    Verdict verdict = Verdict::kNone;
    for (int64_t step = first; step <= end; ++step) verdict = guard.Add(step, Db(db), 0.0);
    return verdict;
  };
  EXPECT_EQ(last(1, 256, 20.0), Verdict::kGood);
  EXPECT_EQ(last(257, 288, 22.0), Verdict::kGood);
  EXPECT_EQ(last(289, 320, 21.9), Verdict::kGood);
  EXPECT_EQ(last(321, 352, 21.5), Verdict::kBad);
}

TEST(FallGuardTest, AResumedGuardJudgesAsOneThatWasNotInterrupted) {
  const auto error = [](int64_t step) { return Db(step < 1500 ? 20.0 : 16.0) * (1.0 + 0.1 * std::sin(static_cast<double>(step))); };
  FallGuard whole, first, second;
  const int64_t fallen = FirstFall(whole, 1, 2000, error);
  ASSERT_GT(fallen, 1500);
  EXPECT_EQ(FirstFall(first, 1, 1024, error), 0);
  second.SetState(first.state());
  EXPECT_EQ(FirstFall(second, 1025, 2000, error), fallen);
}

}  // namespace
}  // namespace skyquilt::worker
