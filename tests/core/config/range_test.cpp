#include "core/config/range.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

namespace skyquilt::config {
namespace {

TEST(Range, TextDescribesTheAllowedValues) {
  EXPECT_EQ(Range().Text(), "");
  EXPECT_EQ((Range{0.25, 16}.Text()), "0.25 to 16");
  EXPECT_EQ((Range{256, 4194304}.Text()), "256 to 4194304");
  EXPECT_EQ((Range{1e-6, 1e8}.Text()), "1e-06 to 1e+08");
  EXPECT_EQ(Range::AtLeast(0).Text(), "0 or more");
  EXPECT_EQ((Range{32, 8192}.Or(0).Text()), "0 or 32 to 8192");
  EXPECT_EQ((Range{0, 0.95}.OrNegative().Text()), "negative or 0 to 0.95");
  EXPECT_EQ((Range{4, 256}.MultipleOf(4).Text()), "4 to 256 in steps of 4");
  EXPECT_EQ(Range::OneOf({1, 4, 16}).Text(), "1, 4 or 16");
  EXPECT_EQ(Range::OneOf({"fp32", "bf16", "fp16"}).Text(), "fp32, bf16 or fp16");
}

TEST(Range, IncludesItsEndsAndNothingBeyond) {
  const Range range{0.25, 16};
  EXPECT_TRUE(range.Contains(0.25));
  EXPECT_TRUE(range.Contains(16));
  EXPECT_FALSE(range.Contains(std::nextafter(0.25, 0.0)));
  EXPECT_FALSE(range.Contains(std::nextafter(16.0, 17.0)));
  const Range even = Range{16, 64}.MultipleOf(2).Or(1);
  EXPECT_TRUE(even.Contains(1));
  EXPECT_TRUE(even.Contains(18));
  EXPECT_FALSE(even.Contains(17));
  EXPECT_FALSE(even.Contains(14));
  EXPECT_FALSE(Range::OneOf({2, 4}).Contains(3.0));
  EXPECT_TRUE(Range::OneOf({"round", "square"}).Contains("round"));
  EXPECT_FALSE(Range::OneOf({"round", "square"}).Contains("roun"));
}

TEST(Range, OfNumbersHoldsNeitherNanNorInfinity) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Range& range : {Range{-1, 1}, Range::AtLeast(0), Range{0, 1}.OrNegative(), Range::OneOf({1, 2})}) {
    for (const double value : {std::nan(""), infinity, -infinity}) EXPECT_FALSE(range.Contains(value)) << range.Text() << ": " << value;
  }
  EXPECT_TRUE(Range().Contains(infinity));
}

RC_GTEST_PROP(RangeProperty, ContainsNumbersBetweenItsEnds, (double a, double b, double value)) {
  RC_PRE(std::isfinite(a) && std::isfinite(b));
  const Range range{std::min(a, b), std::max(a, b)};
  RC_ASSERT(range.Contains(value) == (std::isfinite(value) && value >= std::min(a, b) && value <= std::max(a, b)));
  RC_ASSERT(range.OrNegative().Contains(value) == (range.Contains(value) || (std::isfinite(value) && value < 0.0)));
}

}  // namespace
}  // namespace skyquilt::config
