#include "core/brightness/tone_curve.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/ulp.h"

namespace skyquilt::brightness {
namespace {

// The published curve, cut where the float code cuts it.
constexpr auto kLow = static_cast<double>(kSafe), kHigh = static_cast<double>(1.0F - kSafe);
double Published(double x) {
  return 0.5 - std::sin(std::asin(1.0 - 2.0 * x) / 3.0);
}
// A central difference, right to nine digits.
double ExactSlope(double x) {
  const double inside = std::clamp(x, kLow, kHigh);
  const double h = 3e-5 * inside * (1.0 - inside);
  return (Published(inside + h) - Published(inside - h)) / (2.0 * h);
}
double ExactValue(double x) {
  const double inside = std::clamp(x, kLow, kHigh);
  return Published(inside) + ExactSlope(x) * (x - inside);
}

TEST(ToneCurve, IsThePublishedOneWithinItsErrors) {
  const auto value = testing::EachValue([](float x) { return ToneCurve(x).value; });
  const auto slope = testing::EachValue([](float x) { return ToneCurve(x).slope; });
  // Worst seen over 16 million floats with the GNU C library 2.36: 2.14 ulp where the error is above 1.9e-7, 3.94 ulp for the slope. A small value is
  // a difference of numbers near a half, whose ulp it keeps; residuals of the loss are of order one, so nothing is lost.
  testing::ExpectWithinUlp({"tone curve", ExactValue, -4.0F, 4.0F, 2.3, 1.9e-7}, "the C library", value);
  testing::ExpectWithinUlp({"slope of the tone curve", ExactSlope, -4.0F, 4.0F, 4.1}, "the C library", slope);
}

TEST(ToneCurve, RisesAndStaysFiniteEverywhere) {
  EXPECT_TRUE(rc::check("monotone, finite value and slope", [](int a, int b) {
    // Steps of 1e-4 over +-200000 of them: -20 to 20, ends included.
    const float x = static_cast<float>(a % 200'000) * 1e-4F, y = static_cast<float>(b % 200'000) * 1e-4F;
    const Toned at_x = ToneCurve(x), at_y = ToneCurve(y);
    RC_ASSERT(std::isfinite(at_x.value) && std::isfinite(at_x.slope) && at_x.slope > 0.0F);
    if (x < y) RC_ASSERT(at_x.value < at_y.value);
  }));
  for (const float x : {0.0F, 1.0F, -1e30F, 1e30F, std::numeric_limits<float>::denorm_min()}) {
    EXPECT_TRUE(std::isfinite(ToneCurve(x).value)) << x;
    EXPECT_TRUE(std::isfinite(ToneCurve(x).slope)) << x;
  }
}

}  // namespace
}  // namespace skyquilt::brightness
