#include "bench/study/compare.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/random.h"

namespace skyquilt::bench {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

std::vector<double> InHundredths(const std::vector<int16_t>& numbers) {
  std::vector<double> values;
  values.reserve(numbers.size());
  for (const int16_t number : numbers) values.push_back(0.01 * number);
  return values;
}

RC_GTEST_PROP(DifferenceOf, DoesNotDependOnTheOrderAndTurnsItsSignWithThePairs, (std::vector<int16_t> numbers)) {
  std::vector<double> pairs = InHundredths(numbers);
  const Difference difference = DifferenceOf(pairs, kNoise_db);
  std::sort(pairs.begin(), pairs.end());
  for (double& value : pairs) value = -value;
  pairs.push_back(kNotANumber);
  const Difference turned = DifferenceOf(pairs, kNoise_db);
  RC_ASSERT(difference.pairs == static_cast<int>(numbers.size()));
  RC_ASSERT(turned.pairs == difference.pairs);
  if (numbers.empty()) return;
  const bool tied = std::abs(std::abs(difference.median) - difference.noise) < 1e-9;
  RC_ASSERT(tied || turned.seen == difference.seen);
  RC_ASSERT(std::abs(turned.median + difference.median) < 1e-9);
  RC_ASSERT(std::abs(turned.noise - difference.noise) < 1e-6);
}

RC_GTEST_PROP(DifferenceOf, OfThreePairsOrMoreIsSeenAtAnyScale, (std::vector<int16_t> numbers, int16_t a, int16_t b, int16_t c)) {
  numbers.insert(numbers.end(), {a, b, c});
  std::vector<double> pairs = InHundredths(numbers);
  const Difference difference = DifferenceOf(pairs, kNotANumber);
  if (std::abs(std::abs(difference.median) - difference.noise) < 1e-9) return;
  for (double& value : pairs) value *= 1024.0;
  RC_ASSERT(DifferenceOf(pairs, kNoise_db).seen == difference.seen);
}

TEST(DifferenceOf, OfSingleTrainingsMustExceedTheirKnownNoise) {
  EXPECT_FALSE(DifferenceOf({0.29}, kNoise_db).seen);
  EXPECT_TRUE(DifferenceOf({-0.31}, kNoise_db).seen);
  EXPECT_TRUE(DifferenceOf({0.2, 0.6}, kNoise_db).seen);
  EXPECT_FALSE(DifferenceOf({-0.1, 0.6}, kNoise_db).seen);
  EXPECT_FALSE(DifferenceOf({100.0}, kNotANumber).seen) << "unknown noise shows nothing";
}

TEST(DifferenceOf, OfSeveralPairsMustExceedTheirOwnSpread) {
  const Difference scattered = DifferenceOf({0.25, 0.15, 0.01}, kNoise_db);
  EXPECT_DOUBLE_EQ(scattered.median, 0.15);
  EXPECT_NEAR(scattered.noise, 4.303 * std::sqrt(std::numbers::pi / 2.0) * 0.120554 / std::sqrt(3.0), 1e-4);
  EXPECT_FALSE(scattered.seen);
  EXPECT_TRUE(DifferenceOf({0.16, 0.15, 0.13}, kNoise_db).seen) << "smaller than the noise of single trainings, but steady";
  EXPECT_FALSE(DifferenceOf({2.0, 2.1, -1.9}, kNoise_db).seen) << "one pair says the opposite";
  EXPECT_FALSE(DifferenceOf({0.0, 0.0, 0.0}, kNoise_db).seen);
}

// How often the difference of n pairs is seen when it is `true_db` and one pair scatters by 1 dB.
double ShareSeen(int n, double true_db) {
  constexpr int kTries = 4000;
  base::Random random(11);
  int seen = 0;
  for (int i = 0; i < kTries; ++i) {
    std::vector<double> pairs;
    for (int k = 0; k < n; ++k) pairs.push_back(true_db + random.Normal());
    seen += DifferenceOf(std::move(pairs), kNoise_db).seen ? 1 : 0;
  }
  return static_cast<double>(seen) / kTries;
}

TEST(DifferenceOf, IsSeldomSeenBetweenEqualsAndMoreOftenWithMoreSeeds) {
  for (const int n : {3, 4, 5, 8, 12}) EXPECT_LT(ShareSeen(n, 0.0), 0.05) << n;
  EXPECT_LT(ShareSeen(3, 2.0), 0.5);
  EXPECT_GT(ShareSeen(5, 2.0), 0.7);
  EXPECT_GT(ShareSeen(12, 2.0), 0.98);
}

VariantResult WithPsnr(double psnr_db, double common_db = kNotANumber) {
  VariantResult result;
  result.psnr_db = psnr_db;
  result.psnr_common_db = common_db;
  return result;
}

TEST(PsnrDifference, IsOverCommonPixelsWhenBothHaveThem) {
  EXPECT_DOUBLE_EQ(PsnrDifference(WithPsnr(30.0, 28.0), WithPsnr(27.0, 27.5)).median, 0.5);
  EXPECT_DOUBLE_EQ(PsnrDifference(WithPsnr(30.0, 28.0), WithPsnr(27.0)).median, 3.0);
  EXPECT_EQ(PsnrDifference(WithPsnr(30.0, 28.0), {}).pairs, 0);
  const std::vector<VariantResult> results = {WithPsnr(30.0, 28.0), {}, WithPsnr(27.0, 27.5)};
  EXPECT_EQ(ComparablePsnr(PointersTo(results))[2], 27.5) << "a failed one has no pixels";
}

TEST(PsnrDifference, PairsEqualSeeds) {
  // Places differ by more than the variants.
  VariantResult less, more;
  for (const double psnr_db : {24.0, 31.0, 27.0}) {
    less.seeds.push_back(WithPsnr(psnr_db));
    more.seeds.push_back(WithPsnr(psnr_db + 0.2));
  }
  less.psnr_db = 27.0;
  more.psnr_db = 27.2;
  Difference difference = PsnrDifference(more, less);
  EXPECT_EQ(difference.pairs, 3);
  EXPECT_NEAR(difference.median, 0.2, 1e-12);
  EXPECT_TRUE(difference.seen);
  more.seeds[1] = {};
  more.seeds[1].failure = "no memory";
  difference = PsnrDifference(more, less);
  EXPECT_EQ(difference.pairs, 2);
  EXPECT_NEAR(difference.median, 0.2, 1e-12) << "the place without a training on one side does not count";
}

TEST(Shown, SaysWhenNothingIsSeen) {
  EXPECT_EQ(Shown(DifferenceOf({1.2}, kNoise_db)), "+1.20 dB");
  EXPECT_EQ(Shown(DifferenceOf({0.12}, kNoise_db)), "no difference seen (+0.12 dB, noise up to 0.3 dB)");
  EXPECT_EQ(Shown(DifferenceOf({}, kNoise_db)), "not measured");
  EXPECT_EQ(Shown(DifferenceOf({-12.34}, kNotANumber), 1, " %"), "-12.3 %");
  const BenchFigure figure = DifferenceFigure("PSNR", DifferenceOf({0.12}, kNoise_db), "equal time");
  EXPECT_EQ(figure.value, "+0.12 dB");
  EXPECT_EQ(figure.note, "equal time; no difference seen, noise up to 0.3 dB");
  EXPECT_EQ(DifferenceFigure("PSNR", DifferenceOf({1.2}, kNoise_db), "equal time").note, "equal time");
}

}  // namespace
}  // namespace skyquilt::bench
