#include "core/base/amounts.h"

#include <gtest/gtest.h>

#include <limits>

namespace skyquilt::base {
namespace {

TEST(Amounts, Durations) {
  EXPECT_EQ(FormatDuration(0.0), "0.0s");
  EXPECT_EQ(FormatDuration(12.34), "12.3s");
  EXPECT_EQ(FormatDuration(59.97), "1m00s");
  EXPECT_EQ(FormatDuration(200.0), "3m20s");
  EXPECT_EQ(FormatDuration(3599.7), "1h00m");
  EXPECT_EQ(FormatDuration(3720.0), "1h02m");
  EXPECT_EQ(FormatDuration(3720.0, {" s", " min", " h", " "}), "1 h 02 min");
  EXPECT_EQ(FormatDuration(std::numeric_limits<double>::quiet_NaN()), "?");
  EXPECT_EQ(FormatDuration(std::numeric_limits<double>::infinity()), "?");
}

TEST(Amounts, CountsWithPrefixes) {
  EXPECT_EQ(FormatCount(0.0), "0");
  EXPECT_EQ(FormatCount(532.0), "532");
  EXPECT_EQ(FormatCount(0.25), "0.25");
  EXPECT_EQ(FormatCount(999.7), "1.00 k");
  EXPECT_EQ(FormatCount(12345.0), "12.3 k");
  EXPECT_EQ(FormatCount(1.5e6), "1.50 M");
  EXPECT_EQ(FormatCount(-2.0e9), "-2.00 G");
}

TEST(Amounts, CountsAreGroupedByThousands) {
  EXPECT_EQ(CountText(0, "triangle"), "0 triangles");
  EXPECT_EQ(CountText(1, "triangle"), "1 triangle");
  EXPECT_EQ(CountText(999, "point"), "999 points");
  EXPECT_EQ(CountText(335120, "triangle"), "335,120 triangles");
  EXPECT_EQ(CountText(20000000, "point"), "20,000,000 points");
  EXPECT_EQ(GroupDigits(-123), "-123");
  EXPECT_EQ(GroupDigits(-1234, " "), "-1 234");
}

}  // namespace
}  // namespace skyquilt::base
