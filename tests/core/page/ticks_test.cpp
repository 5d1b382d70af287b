#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/page/plot_frame.h"

namespace skyquilt::page {
namespace {

TEST(RoundTicks, AreRoundNumbersInsideTheRange) {
  const auto ticks = RoundTicks(0.0, 97.0, 5);
  EXPECT_EQ(ticks, (std::vector<double>{0, 20, 40, 60, 80}));
  for (const double tick : RoundTicks(-3.7, 12.2, 6)) {
    EXPECT_GE(tick, -3.7);
    EXPECT_LE(tick, 12.2);
  }
  EXPECT_TRUE(RoundTicks(1.0, 1.0, 5).empty());
  EXPECT_TRUE(RoundTicks(0.0, std::numeric_limits<double>::infinity(), 5).empty());
}

TEST(TickLabel, HasTheDigitsThatTheNumberNeeds) {
  EXPECT_EQ(TickLabel(0.0), "0");
  EXPECT_EQ(TickLabel(10.0), "10");
  EXPECT_EQ(TickLabel(0.05), "0.05");
  EXPECT_EQ(TickLabel(25000.0), "25.0\xE2\x80\xAFk");
}

TEST(LogTicks, ArePowersOfTenOrMoreWhereThereAreFew) {
  EXPECT_EQ(LogTicks(0.0, 3.0), (std::vector<double>{0, 1, 2, 3}));
  EXPECT_EQ(LogTicks(0.0, 1.0).size(), 4U);  // 1, 2, 5, 10
  for (const double tick : LogTicks(std::log10(70.0), std::log10(95.0))) {
    EXPECT_NEAR(std::remainder(std::pow(10.0, tick), 5.0), 0.0, 1e-9) << "70, 75 ... 95";
  }
}

}  // namespace
}  // namespace skyquilt::page
