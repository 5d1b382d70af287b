#include "simulate/noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"

namespace skyquilt::simulate {
namespace {

TEST(ValueNoise, StaysInRangeAndIsContinuous) {
  base::Random random(7);
  for (int i = 0; i < 2000; ++i) {
    const float x = static_cast<float>(random.Uniform(-50.0, 50.0));
    const float y = static_cast<float>(random.Uniform(-50.0, 50.0));
    const float here = ValueNoise(x, y, 3U);
    EXPECT_LE(std::abs(here), 1.0F);
    EXPECT_NEAR(here, ValueNoise(x + 1e-3F, y, 3U), 0.01F);
  }
  // Continuous across lattice lines, on both sides of zero.
  for (const float line : {-2.0F, 0.0F, 3.0F}) EXPECT_NEAR(ValueNoise(line - 1e-4F, 0.3F, 3U), ValueNoise(line + 1e-4F, 0.3F, 3U), 1e-3F);
}

TEST(FractalNoise, OctavesBelowTheFootprintVanish) {
  const FractalShape shape{8.0F, 6, 0.5F};
  const FractalShape coarse_only{8.0F, 1, 0.5F};
  for (int i = 0; i < 100; ++i) {
    const float x = 1.37F * static_cast<float>(i);
    // The second octave (4 m) is left out, the first (8 m) is complete.
    EXPECT_FLOAT_EQ(FractalNoise(x, 2.0F, shape, 1U, 2.0F), FractalNoise(x, 2.0F, coarse_only, 1U, 0.0F));
    EXPECT_EQ(FractalNoise(x, 2.0F, shape, 1U, 100.0F), 0.0F);
  }
}

TEST(PulseTrain, IsTheBoxFilterOfThePulses) {
  for (const float width : {0.05F, 0.3F, 1.0F, 2.7F}) {
    for (float x = -2.0F; x < 2.0F; x += 0.13F) {
      int inside = 0;
      constexpr int kSteps = 20000;
      for (int i = 0; i < kSteps; ++i) {
        const float at = x + width * ((static_cast<float>(i) + 0.5F) / kSteps - 0.5F);
        if (at - std::floor(at) < 0.4F) ++inside;
      }
      EXPECT_NEAR(PulseTrain(x, 0.4F, width), static_cast<float>(inside) / kSteps, 2e-3F) << "x " << x << " width " << width;
    }
  }
}

}  // namespace
}  // namespace skyquilt::simulate
