#include <gtest/gtest.h>

#include <limits>

#include "core/base/random.h"
#include "core/kernel/kernels.h"
#include "core/kernel/reference.h"
#include "tests/support/each_instruction_set.h"
#include "tests/support/gradient_check.h"

namespace skyquilt::kernel {
namespace {

using HashKernels = testing::EachInstructionSet;
SKYQUILT_EACH_INSTRUCTION_SET(HashKernels);

GridLevel Hashed() {
  GridLevel level;
  level.cells_per_unit = 37.0F;
  level.size[0] = level.size[1] = 38;
  level.size[2] = 12;
  level.dense = false;
  level.entries = 256;
  return level;
}

GridLevel DenseLevel() {
  GridLevel level;
  level.cells_per_unit = 5.0F;
  level.size[0] = 6;
  level.size[1] = 5;
  level.size[2] = 3;
  level.entries = 90;
  return level;
}

// Worked by hand from Mueller et al. 2022, eq. 4 (primes 1, 2654435761, 805459861) in unsigned 32-bit arithmetic.
TEST(HashIndex, MatchesGoldenNumbers) {
  GridLevel level = Hashed();
  level.entries = 1U << 19U;
  EXPECT_EQ(HashIndex(level, 0, 0, 0), 0U);
  EXPECT_EQ(HashIndex(level, 1, 0, 0), 1U);
  EXPECT_EQ(HashIndex(level, 0, 1, 0), 2654435761U & 0x7FFFFU);
  EXPECT_EQ(HashIndex(level, 0, 0, 1), 805459861U & 0x7FFFFU);
  EXPECT_EQ(HashIndex(level, 3, 5, 7), (3U ^ 387276917U ^ 1343251731U) & 0x7FFFFU);
  EXPECT_EQ(HashIndex(DenseLevel(), 2, 3, 1), 2U + 3U * 6U + 1U * 30U);
}

TEST(HashReference, TableGradientMatchesFiniteDifferences) {
  base::Random random(11);
  for (const GridLevel& level : {Hashed(), DenseLevel()}) {
    std::vector<double> table(level.entries * 2), gradient(table.size(), 0.0);
    for (double& value : table) value = random.Uniform(-1.0, 1.0);
    const double position[3] = {0.31, 0.77, 0.12};
    const std::vector<double> out_gradient = {0.7, -1.3};
    reference::HashBackward(level, position, out_gradient, &gradient);
    testing::ExpectGradient(
        [&](const std::vector<double>& t) {
          const auto out = reference::HashForward(level, 2, t, position);
          return out[0] * out_gradient[0] + out[1] * out_gradient[1];
        },
        table, gradient);
  }
}

TEST_P(HashKernels, ForwardAgreesWithReferenceAtEveryLength) {
  base::Random random(13);
  for (const GridLevel& level : {Hashed(), DenseLevel()}) {
    for (const int features : {2, 4}) {
      std::vector<float> table(level.entries * static_cast<size_t>(features));
      for (float& value : table) value = random.Uniform() - 0.5F;
      for (const int64_t n : {0, 1, 7, 17, 255, 256, 257, 600}) {
        std::vector<float> x, y, z, out(static_cast<size_t>(features) * 640, 9.0F);
        for (int64_t i = 0; i < n; ++i) {
          // A little outside the box too: positions are clamped.
          x.push_back(1.1F * random.Uniform() - 0.05F);
          y.push_back(1.1F * random.Uniform() - 0.05F);
          z.push_back(0.35F * random.Uniform() - 0.02F);
        }
        HashForward(level, features, table.data(), {x.data(), y.data(), z.data()}, n, out.data(), 640);
        for (size_t s = 0; s < static_cast<size_t>(n); ++s) {
          const float position[3] = {x[s], y[s], z[s]};
          const auto expected = reference::HashForward(level, features, table, position);
          for (size_t f = 0; f < expected.size(); ++f) EXPECT_NEAR(out[f * 640 + s], expected[f], 2e-5F);
        }
        EXPECT_EQ(out[static_cast<size_t>(n)], 9.0F);
      }
    }
  }
}

TEST_P(HashKernels, NanPositionGivesFiniteFeatures) {
  const GridLevel level = DenseLevel();
  std::vector<float> table(level.entries * 2, 0.25F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  float out[2];
  HashForward(level, 2, table.data(), {&nan, &nan, &nan}, 1, out, 1);
  EXPECT_FLOAT_EQ(out[0], 0.25F);
}

TEST_P(HashKernels, BackwardAgreesWithReferenceAndMarksExactlyTheLinesItWrote) {
  base::Random random(17);
  const GridLevel level = Hashed();
  for (const size_t features : {2U, 4U}) {
    const size_t n = 23;  // few enough to leave lines untouched
    std::vector<float> x, y, z, out_gradient(features * n);
    for (size_t i = 0; i < n; ++i) {
      x.push_back(random.Uniform());
      y.push_back(random.Uniform());
      z.push_back(0.3F * random.Uniform());
    }
    for (float& g : out_gradient) g = random.Uniform() - 0.5F;
    for (size_t f = 0; f < features; ++f) out_gradient[f * n + 10] = 0.0F;  // a sample without gradient is skipped
    std::vector<float> gradient(level.entries * features, 0.0F);
    std::vector<double> expected(gradient.size(), 0.0);
    std::vector<uint8_t> touched(gradient.size() / kLineFloats, 0);
    HashBackward(level, static_cast<int>(features), {x.data(), y.data(), z.data()}, static_cast<int64_t>(n), out_gradient.data(), n, gradient.data(),
                 touched.data());
    for (size_t s = 0; s < n; ++s) {
      const double position[3] = {static_cast<double>(x[s]), static_cast<double>(y[s]), static_cast<double>(z[s])};
      std::vector<double> g;
      for (size_t f = 0; f < features; ++f) g.push_back(static_cast<double>(out_gradient[f * n + s]));
      reference::HashBackward(level, position, g, &expected);
    }
    for (size_t i = 0; i < gradient.size(); ++i) EXPECT_NEAR(static_cast<double>(gradient[i]), expected[i], 1e-4);
    size_t resting = 0;
    for (size_t line = 0; line < touched.size(); ++line) {
      bool written = false;
      for (size_t i = line * kLineFloats; i < (line + 1) * kLineFloats; ++i) written = written || gradient[i] != 0.0F;
      EXPECT_EQ(touched[line] != 0, written) << line;
      resting += written ? 0U : 1U;
    }
    EXPECT_GT(resting, 0U);
  }
}

TEST_P(HashKernels, AdamMovesOnlyParametersWithAGradient) {
  constexpr size_t kLines = 11;  // more than the eight lines checked at once
  std::vector<float> table(kLines * kLineFloats, 1.0F), gradient(table.size(), 0.0F), m(table.size(), 0.0F), v(table.size(), 0.0F);
  std::vector<uint8_t> touched(kLines, 0);
  constexpr size_t kUp = 9 * kLineFloats + 4, kDown = 9 * kLineFloats + 5, kUnmarked = 3 * kLineFloats;
  gradient[kUp] = 3.0F;
  gradient[kDown] = -0.001F;
  gradient[kUnmarked] = 1.0F;
  touched[9] = 1;
  AdamStep step;
  step.correction1 = 1.0F - step.beta1;
  step.correction2 = 1.0F - step.beta2;
  AdamTouched(step, kLines, touched.data(), table.data(), gradient.data(), m.data(), v.data());
  // The first step of Adam has the size of the learning rate whatever the gradient (Kingma and Ba 2015, section 2.1).
  for (size_t i = 0; i < table.size(); ++i) {
    const float moved = i == kUp ? -step.learning_rate : i == kDown ? step.learning_rate : 0.0F;
    EXPECT_NEAR(table[i], 1.0F + moved, 1e-6F) << i;
    EXPECT_EQ(m[i] != 0.0F, moved != 0.0F) << i;
    EXPECT_EQ(v[i] != 0.0F, moved != 0.0F) << i;
    EXPECT_EQ(gradient[i], i == kUnmarked ? 1.0F : 0.0F) << i;
  }
  EXPECT_EQ(touched[9], 0);
}

TEST(HashKernels, RefuseShapesThatReachPastTheTable) {
  float value = 0.0F;
  const auto forward = [&](const GridLevel& level, int features, int64_t n, size_t stride) {
    HashForward(level, features, &value, {&value, &value, &value}, n, &value, stride);
  };
  EXPECT_THROW(forward(DenseLevel(), 3, 1, 1), std::logic_error);
  EXPECT_THROW(forward(DenseLevel(), 2, -1, 1), std::logic_error);
  EXPECT_THROW(forward(DenseLevel(), 2, 2, 1), std::logic_error);
  GridLevel level = DenseLevel();
  level.entries = 89;
  EXPECT_THROW(forward(level, 2, 1, 1), std::logic_error) << "a lattice point without an entry";
  level = Hashed();
  level.entries = 255;
  EXPECT_THROW(forward(level, 2, 1, 1), std::logic_error) << "no power of two";
  level = Hashed();
  level.size[2] = 1;
  EXPECT_THROW(forward(level, 2, 1, 1), std::logic_error) << "no cell";
}

}  // namespace
}  // namespace skyquilt::kernel
