#include "core/base/order_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::base {
namespace {

TEST(OrderStatistics, QuantilesAreLinearBetweenRanks) {
  EXPECT_DOUBLE_EQ(Quantile({3.0, 1.0, 2.0, 4.0}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(Quantile({3.0, 1.0, 2.0}, 0.0), 1.0);
  EXPECT_DOUBLE_EQ(Quantile({3.0, 1.0, 2.0}, 1.0), 3.0);
  EXPECT_DOUBLE_EQ(Quantile({3.0, 1.0, 2.0}, 7.0), 3.0);
  EXPECT_DOUBLE_EQ(Quantile({7.0}, 0.3), 7.0);
  EXPECT_TRUE(std::isnan(Quantile({}, 0.5)));
  EXPECT_DOUBLE_EQ(Median({5.0, 1.0, 2.0}), 2.0);
  EXPECT_DOUBLE_EQ(Median({5.0, 1.0, 2.0, 4.0}), 3.0);
}

TEST(OrderStatistics, NmadIsTheSpreadOfMostValues) {
  EXPECT_DOUBLE_EQ(Nmad({10.0, 11.0, 12.0, 8.0, 1000.0}), kMadToSigma * 1.0) << "1, 0, 1, 3 and 989 from the median";
  EXPECT_DOUBLE_EQ(Nmad({4.0}), 0.0);
  EXPECT_TRUE(std::isnan(Nmad({})));
}

TEST(OrderStatistics, RanksCountFromTheSmallest) {
  std::vector<int> values = {40, 10, 30, 20};
  EXPECT_EQ(OrderStatistic(values, 0), 10);
  EXPECT_EQ(OrderStatistic(values, 3), 40);
  EXPECT_EQ(UpperMedian(values), 30);
  EXPECT_EQ(NearestRankQuantile(values, 0.3), 20);
  EXPECT_EQ(NearestRankQuantile(values, 0.6), 30);
  EXPECT_EQ(NearestRankQuantile(values, 1.0), 40);
}

}  // namespace
}  // namespace skyquilt::base
