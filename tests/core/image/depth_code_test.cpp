#include "core/image/depth_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/base/deflate.h"

namespace skyquilt::image {
namespace {

constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

TEST(DepthCode, HalvesToEverySecondPixel) {
  const std::vector<float> depths = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  EXPECT_EQ(HalfDepths(depths, 5, 3, DepthScale::kInverse), (std::vector<float>{1, 3, 5, 11, 13, 15}));
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> bad = HalfDepths(std::vector<float>{-1, 0, 0, 0, inf}, 5, 1, DepthScale::kInverse);
  for (const float d : bad) EXPECT_TRUE(std::isnan(d));
  EXPECT_EQ(HalfDepths(std::vector<float>{-1, 0, 0}, 3, 1, DepthScale::kLinear), (std::vector<float>{-1, 0})) << "parallel rays start anywhere";
}

TEST(DepthCode, RangeLeavesOutPixelsWithoutSurface) {
  const auto range = RangeOfDepths(std::vector<float>{kNoDepth, 4, 2.5, kNoDepth, 9});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->near_m, 2.5F);
  EXPECT_EQ(range->far_m, 9.0F);
  EXPECT_FALSE(RangeOfDepths(std::vector<float>{kNoDepth, kNoDepth}));
}

// Half a step of the inverse at every distance: the same error of the parallax.
TEST(DepthCode, InverseDepthsComeBackWithinHalfAStep) {
  const DepthRange range{0.8F, 900.0F};
  std::vector<float> depths;
  for (float d = range.near_m; d < range.far_m; d *= 1.003F) depths.push_back(d);
  depths.push_back(range.far_m);
  depths.push_back(kNoDepth);
  const std::vector<float> back = UnpackDepths(PackDepths(depths, range, DepthScale::kInverse), depths.size(), range, DepthScale::kInverse);
  const double half_step = 0.5 * (1.0 / 0.8 - 1.0 / 900.0) / 65534.0;
  for (size_t i = 0; i + 1 < depths.size(); ++i) {
    // 2e-7: floats.
    const double d = static_cast<double>(depths[i]);
    EXPECT_NEAR(1.0 / static_cast<double>(back[i]), 1.0 / d, half_step + 2e-7 / d) << depths[i];
  }
  EXPECT_TRUE(std::isnan(back.back()));
}

TEST(DepthCode, LinearDepthsComeBackWithinHalfAStep) {
  const DepthRange range{-20.0F, 300.0F};
  const std::vector<float> depths = {-20.0F, -3.7F, 0.0F, kNoDepth, 111.1F, 300.0F};
  const std::vector<float> back = UnpackDepths(PackDepths(depths, range, DepthScale::kLinear), depths.size(), range, DepthScale::kLinear);
  for (size_t i = 0; i < depths.size(); ++i) {
    if (i == 3) {
      EXPECT_TRUE(std::isnan(back[i]));
    } else {
      EXPECT_NEAR(back[i], depths[i], 0.5F * 320.0F / 65534.0F + 1e-5F);
    }
  }
}

TEST(DepthCode, ValuesOutsideTheRangeCountAsAtItsEnds) {
  const DepthRange range{2.0F, 8.0F};
  const std::vector<float> back =
      UnpackDepths(PackDepths(std::vector<float>{0.001F, 1000.0F}, range, DepthScale::kInverse), 2, range, DepthScale::kInverse);
  EXPECT_FLOAT_EQ(back[0], 2.0F);
  EXPECT_FLOAT_EQ(back[1], 8.0F);
}

TEST(DepthCode, OneDepthIsARange) {
  const DepthRange range{50.0F, 50.0F};
  EXPECT_FLOAT_EQ(UnpackDepths(PackDepths(std::vector<float>{50.0F}, range, DepthScale::kInverse), 1, range, DepthScale::kInverse)[0], 50.0F);
}

// Programs in other languages read these bytes.
TEST(DepthCode, HasTheDocumentedLayout) {
  const std::string packed = PackDepths(std::vector<float>{kNoDepth, 2.0F, 4.0F}, {2.0F, 4.0F}, DepthScale::kInverse);
  EXPECT_EQ(base::Inflate(packed, 6), std::string("\x00\x00\xFF\xFF\x01\x00", 6));
}

TEST(DepthCode, RefusesDamage) {
  const std::string packed = PackDepths(std::vector<float>{2.0F, 4.0F}, {2.0F, 4.0F}, DepthScale::kInverse);
  EXPECT_THROW(UnpackDepths(packed, 3, {2.0F, 4.0F}, DepthScale::kInverse), std::runtime_error);
  EXPECT_THROW(UnpackDepths(packed, 2, {4.0F, 2.0F}, DepthScale::kInverse), std::runtime_error);
  EXPECT_THROW(UnpackDepths(packed, 2, {0.0F, 2.0F}, DepthScale::kInverse), std::runtime_error);
  EXPECT_THROW(UnpackDepths(packed, 2, {kNoDepth, 2.0F}, DepthScale::kInverse), std::runtime_error);
}

}  // namespace
}  // namespace skyquilt::image
