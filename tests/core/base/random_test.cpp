#include "core/base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

namespace skyquilt::base {
namespace {

// Output of the reference implementation, pcg32-demo with seed 42 and stream 54 (pcg-random.org, pcg-c-basic 0.9).
TEST(Random, MatchesTheReferenceSequence) {
  Random random(42, 54);
  for (const uint32_t expected : {0xa15c02b7U, 0x7b47f409U, 0xba1d3330U, 0x83d2f293U, 0xbfa4784bU, 0xcbed606eU}) {
    EXPECT_EQ(random.NextU32(), expected);
  }
}

TEST(Random, RestoreContinuesTheSequence) {
  Random random(7, 3);
  for (int i = 0; i < 5; ++i) random.Normal();
  Random restored;
  restored.Restore(random.state(), random.increment());
  for (int i = 0; i < 100; ++i) ASSERT_EQ(random.NextU32(), restored.NextU32());
}

TEST(Random, StreamsDiffer) {
  Random a(1, 0);
  Random b(1, 1);
  int n_equal = 0;
  for (int i = 0; i < 1000; ++i) n_equal += a.NextU32() == b.NextU32() ? 1 : 0;
  EXPECT_LT(n_equal, 3);
}

TEST(Random, UniformStaysInsideAndFillsTheRange) {
  Random random(11);
  std::vector<int> seen(10, 0);
  double sum = 0.0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const float single = random.Uniform();
    const double wide = random.Uniform(-3.0, 5.0);
    ASSERT_TRUE(single >= 0.0F && single < 1.0F);
    ASSERT_TRUE(wide >= -3.0 && wide < 5.0);
    sum += wide;
    const uint32_t below = random.Below(10);
    ASSERT_LT(below, 10U);
    ++seen[below];
  }
  // Standard error of the mean: 8 / sqrt(12 n) = 0.0073; of a count: 95. Five of them are allowed.
  EXPECT_NEAR(sum / kDraws, 1.0, 0.037);
  for (const int count : seen) EXPECT_NEAR(count, kDraws / 10, 475);
  EXPECT_EQ(random.Below(0), 0U);
  EXPECT_EQ(random.Below(1), 0U);
}

TEST(Random, NormalHasUnitMoments) {
  Random random(5);
  constexpr int kDraws = 200000;
  double sum = 0.0;
  double squares = 0.0;
  double fourths = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.Normal();
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
    fourths += x * x * x * x;
  }
  // Standard errors: 0.0022, 0.0032, 0.022; five of each are allowed.
  EXPECT_NEAR(sum / kDraws, 0.0, 0.011);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.016);
  EXPECT_NEAR(fourths / kDraws, 3.0, 0.11);
}

TEST(RandomToken, IsAnotherEveryTime) {
  std::set<std::string> tokens;
  for (int i = 0; i < 1000; ++i) {
    const std::string token = RandomToken();
    EXPECT_EQ(token.size(), 16U);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos) << token;
    EXPECT_TRUE(tokens.insert(token).second) << token;
  }
}

}  // namespace
}  // namespace skyquilt::base
