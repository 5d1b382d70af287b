#include "tour/pictures/jpeg_quality.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace skyquilt::tour {
namespace {

TEST(JpegQuality, IsTheHighestThatKeepsToTheLimit) {
  int calls = 0;
  const auto bytes_at = [&calls](int quality) {
    ++calls;
    return int64_t{1000} * quality;
  };
  for (int64_t limit = 60'000; limit <= 93'000; limit += 250) {
    calls = 0;
    const JpegFit fit = FitQuality(bytes_at, limit);
    EXPECT_TRUE(fit.fits);
    EXPECT_EQ(fit.quality, std::min<int64_t>(limit / 1000, kMostQuality));
    EXPECT_EQ(fit.bytes, 1000 * fit.quality);
    EXPECT_LE(calls, 7);
  }
}

TEST(JpegQuality, SaysWhenNothingKeepsToTheLimit) {
  const JpegFit fit = FitQuality([](int quality) { return int64_t{1000} * quality; }, 59'999);
  EXPECT_FALSE(fit.fits);
  EXPECT_EQ(fit.quality, kLeastQuality);
  EXPECT_EQ(fit.bytes, 60'000);
}

// Tables of quantisation are rounded, so a higher quality may give a slightly smaller file.
TEST(JpegQuality, KeepsToTheLimitWhenBytesDoNotQuiteGrow) {
  const auto bytes_at = [](int quality) { return int64_t{1000} * quality + (quality % 3 == 0 ? 2500 : 0); };
  for (int64_t limit = 63'000; limit <= 95'000; limit += 111) {
    const JpegFit fit = FitQuality(bytes_at, limit);
    EXPECT_TRUE(fit.fits);
    EXPECT_LE(fit.bytes, limit);
    EXPECT_EQ(fit.bytes, bytes_at(fit.quality));
  }
}

}  // namespace
}  // namespace skyquilt::tour
