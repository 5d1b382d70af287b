#include "core/base/half.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/not_finite.h"

namespace skyquilt::base {
namespace {

template <typename ToHalf, typename ToFloat>
void ExpectEveryHalfComesBack(ToHalf to_half, ToFloat to_float, float largest) {
  for (uint32_t bits = 0; bits <= 0xFFFFU; ++bits) {
    const auto half = static_cast<uint16_t>(bits);
    const float value = to_float(half);
    if (std::isnan(value)) {
      EXPECT_TRUE(std::isnan(to_float(to_half(value)))) << bits;
    } else if (std::isinf(value)) {
      EXPECT_EQ(to_float(to_half(value)), std::copysign(largest, value));
    } else {
      EXPECT_EQ(to_half(value), half) << bits;
    }
  }
}

TEST(Half, EveryFloat16IsUnchangedByConversionToFloatAndBack) {
  ExpectEveryHalfComesBack(Float16FromFloat, FloatFromFloat16, kLargestFloat16);
}

TEST(Half, EveryBfloat16IsUnchangedByConversionToFloatAndBack) {
  ExpectEveryHalfComesBack(Bfloat16FromFloat, FloatFromBfloat16, kLargestBfloat16);
}

// Checks that the result is the nearest number of the format, by comparing it with its two neighbours.
template <typename ToHalf, typename ToFloat>
void ExpectNearest(float value, ToHalf to_half, ToFloat to_float) {
  const uint16_t half = to_half(value);
  const double error = std::abs(static_cast<double>(to_float(half)) - static_cast<double>(value));
  for (const int step : {-1, 1}) {
    const auto neighbour = static_cast<uint16_t>(half + step);
    const float other = to_float(neighbour);
    if (!std::isfinite(other) || std::signbit(other) != std::signbit(value)) continue;
    const double other_error = std::abs(static_cast<double>(other) - static_cast<double>(value));
    EXPECT_LE(error, other_error) << value;
    EXPECT_TRUE(error < other_error || (half & 1) == 0) << "a tie goes to even: " << value;
  }
}

TEST(Half, RoundsToTheNearestAndTiesToEven) {
  std::mt19937 random(7);
  std::uniform_int_distribution<uint32_t> any;
  for (int i = 0; i < 200000; ++i) {
    const float value = std::bit_cast<float>(any(random));
    if (!std::isfinite(value)) continue;
    if (std::abs(value) < kLargestFloat16) ExpectNearest(value, Float16FromFloat, FloatFromFloat16);
    if (std::abs(value) < kLargestBfloat16) ExpectNearest(value, Bfloat16FromFloat, FloatFromBfloat16);
  }
  EXPECT_EQ(FloatFromBfloat16(Bfloat16FromFloat(1.0F + 0x1p-8F)), 1.0F);
  EXPECT_EQ(FloatFromBfloat16(Bfloat16FromFloat(1.0F + 0x3p-8F)), 1.0F + 0x1p-6F);
  EXPECT_EQ(FloatFromFloat16(Float16FromFloat(0x1p-25F)), 0.0F);
  EXPECT_EQ(FloatFromFloat16(Float16FromFloat(0x3p-25F)), 0x1p-23F);
}

TEST(Half, OverflowStaysFinite) {
  for (const float sign : {-1.0F, 1.0F}) {
    for (const float value : {65504.0F, 65519.0F, 65520.0F, 1e30F, kInfinityFloat}) {
      EXPECT_EQ(FloatFromFloat16(Float16FromFloat(sign * value)), sign * kLargestFloat16) << value;
    }
    for (const float value : {3.4e38F, std::numeric_limits<float>::max(), kInfinityFloat}) {
      EXPECT_EQ(FloatFromBfloat16(Bfloat16FromFloat(sign * value)), sign * kLargestBfloat16) << value;
    }
  }
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(FloatFromFloat16(Float16FromFloat(nan))));
  EXPECT_TRUE(std::isnan(FloatFromBfloat16(Bfloat16FromFloat(nan))));
}

}  // namespace
}  // namespace skyquilt::base
