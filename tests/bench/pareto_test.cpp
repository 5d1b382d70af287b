#include "bench/study/pareto.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <limits>

namespace skyquilt::bench {
namespace {

std::vector<Priced> FromPairs(const std::vector<std::pair<int, int>>& pairs) {
  std::vector<Priced> points;
  points.reserve(pairs.size());
  for (const auto& [cost, quality] : pairs) points.push_back({static_cast<double>(cost), static_cast<double>(quality)});
  return points;
}

RC_GTEST_PROP(ParetoFront, ContainsExactlyThePointsThatNoOtherBeats, (const std::vector<std::pair<uint8_t, uint8_t>>& pairs)) {
  const std::vector<Priced> points = FromPairs({pairs.begin(), pairs.end()});
  const std::vector<size_t> front = ParetoFront(points);
  for (size_t i = 0; i < points.size(); ++i) {
    const bool beaten = std::any_of(points.begin(), points.end(), [&](const Priced& other) {
      return (other.cost < points[i].cost && other.quality >= points[i].quality) ||
             (other.cost <= points[i].cost && other.quality > points[i].quality);
    });
    const bool on_front =
        std::any_of(front.begin(), front.end(), [&](size_t k) { return points[k].cost == points[i].cost && points[k].quality == points[i].quality; });
    RC_ASSERT(on_front == !beaten);
    const Priced& best = points[BestForCost(points, i)];
    RC_ASSERT(best.quality >= points[i].quality);
    RC_ASSERT(best.cost <= points[i].cost);
    if (on_front) RC_ASSERT(BestForCost(points, i) == i);
  }
  for (size_t k = 1; k < front.size(); ++k) {
    RC_ASSERT(points[front[k]].cost > points[front[k - 1]].cost);
    RC_ASSERT(points[front[k]].quality > points[front[k - 1]].quality);
  }
}

TEST(ParetoFront, IgnoresNaN) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ParetoFront({{1.0, nan}, {nan, 9.0}, {2.0, 3.0}}), std::vector<size_t>{2});
  EXPECT_TRUE(ParetoFront({}).empty());
  EXPECT_EQ(BestForCost({{1.0, 30.0}, {2.0, 29.5}, {2.0, nan}, {3.0, 31.0}}, 1), 0U);
}

TEST(BestForCost, TreatsNearlyEqualCostsAsEqual) {
  const std::vector<Priced> points = {{100.0, 30.0}, {101.0, 30.4}, {110.0, 32.0}};
  EXPECT_EQ(BestForCost(points, 0), 0U);
  EXPECT_EQ(BestForCost(points, 0, 0.02), 1U);
  EXPECT_EQ(BestForCost(points, 2, 0.02), 2U);
}

}  // namespace
}  // namespace skyquilt::bench
