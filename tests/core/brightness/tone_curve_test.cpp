#include "core/brightness/tone_curve.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace skyquilt::brightness {
namespace {

TEST(ToneCurve, HasThePublishedFormInside) {
  for (const double x : {0.01, 0.1, 0.3, 0.5, 0.77, 0.99}) {
    EXPECT_NEAR(static_cast<double>(ToneCurve(static_cast<float>(x)).value), 0.5 - std::sin(std::asin(1.0 - 2.0 * x) / 3.0), 1e-6);
  }
  EXPECT_NEAR(ToneCurve(0.5F).value, 0.5F, 1e-6F);
}

TEST(ToneCurve, SlopeMatchesFiniteDifferences) {
  for (const float x : {-3.0F, -0.01F, 0.0F, 5e-4F, 0.01F, 0.2F, 0.5F, 0.9F, 0.999F, 1.0F, 1.5F, 4.0F}) {
    const float h = 1e-4F;
    const float numeric = (ToneCurve(x + h).value - ToneCurve(x - h).value) / (2.0F * h);
    EXPECT_NEAR(ToneCurve(x).slope, numeric, 0.02F * ToneCurve(x).slope) << x;
  }
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
