#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/kernel/kernels.h"
#include "core/kernel/reference.h"
#include "tests/support/each_instruction_set.h"
#include "tests/support/gradient_check.h"

namespace skyquilt::kernel {
namespace {

using DenseKernels = testing::EachInstructionSet;
SKYQUILT_EACH_INSTRUCTION_SET(DenseKernels);

std::vector<double> RandomVector(base::Random& random, size_t n) {
  std::vector<double> v(n);
  for (double& value : v) value = random.Uniform(-1.0, 1.0);
  return v;
}

TEST(DenseReference, GradientsMatchFiniteDifferences) {
  base::Random random(3);
  for (const bool relu : {false, true}) {
    const auto weights = RandomVector(random, 5 * 7);
    const auto in = RandomVector(random, 7);
    const auto out_gradient = RandomVector(random, 5);
    const auto loss = [&](const std::vector<double>& w, const std::vector<double>& x) {
      const auto out = reference::Dense(w, 5, x, relu);
      double sum = 0.0;
      for (size_t o = 0; o < out.size(); ++o) sum += out[o] * out_gradient[o];
      return sum;
    };
    std::vector<double> in_gradient, weight_gradient(weights.size(), 0.0);
    reference::DenseBackward(weights, in, reference::Dense(weights, 5, in, relu), relu, out_gradient, &in_gradient, &weight_gradient);
    testing::ExpectGradient([&](const auto& x) { return loss(weights, x); }, in, in_gradient);
    testing::ExpectGradient([&](const auto& w) { return loss(w, in); }, weights, weight_gradient);
  }
}

TEST_P(DenseKernels, AgreesWithReference) {
  base::Random random(5);
  for (const int n_in : {4, 12, 28, 32, 64}) {
    for (const int n_out : {4, 16, 64}) {
      for (const int64_t n : {0, 16, 48, 80, 112, 512}) {
        const size_t stride = static_cast<size_t>(n) + 64;
        std::vector<float> weights(static_cast<size_t>(n_out * n_in)), in(static_cast<size_t>(n_in) * stride),
            out(static_cast<size_t>(n_out) * stride, -7.0F);
        for (float& w : weights) w = random.Uniform() - 0.5F;
        for (float& x : in) x = random.Uniform() - 0.5F;
        Dense(weights.data(), n_out, n_in, in.data(), stride, n, true, out.data(), stride);
        for (size_t s = 0; s < static_cast<size_t>(n); s += 13) {
          std::vector<float> column;
          column.reserve(static_cast<size_t>(n_in));
          for (int i = 0; i < n_in; ++i) column.push_back(in[static_cast<size_t>(i) * stride + s]);
          const auto expected = reference::Dense(weights, n_out, column, true);
          // Sums of at most 64 products below 1/4: float rounding stays under 1e-5.
          for (size_t o = 0; o < expected.size(); ++o) EXPECT_NEAR(out[o * stride + s], expected[o], 1e-5F);
        }
        // Nothing past the batch is written.
        for (size_t o = 0; o < static_cast<size_t>(n_out); ++o) EXPECT_EQ(out[o * stride + static_cast<size_t>(n)], -7.0F);
      }
    }
  }
}

TEST_P(DenseKernels, WeightGradientAgreesWithReferenceAndAdds) {
  base::Random random(7);
  const int n_in = 28, n_out = 16;
  const int64_t n = 128;
  const size_t stride = 128;
  std::vector<float> in(static_cast<size_t>(n_in) * stride), gradient(static_cast<size_t>(n_out) * stride),
      sum(static_cast<size_t>(n_in * n_out), 1.0F);
  for (float& x : in) x = random.Uniform() - 0.5F;
  for (float& g : gradient) g = random.Uniform() - 0.5F;
  DenseWeightGradient(gradient.data(), stride, n_out, in.data(), stride, n_in, n, sum.data());
  for (int o = 0; o < n_out; ++o) {
    for (int i = 0; i < n_in; ++i) {
      double expected = 1.0;
      for (size_t s = 0; s < stride; ++s) {
        expected += static_cast<double>(gradient[static_cast<size_t>(o) * stride + s]) * static_cast<double>(in[static_cast<size_t>(i) * stride + s]);
      }
      EXPECT_NEAR(static_cast<double>(sum[static_cast<size_t>(o * n_in + i)]), expected, 2e-5);
    }
  }
}

TEST(Dense, RefusesUnpaddedShapes) {
  float buffer[64] = {};
  EXPECT_THROW(Dense(buffer, 3, 4, buffer, 64, 64, false, buffer, 64), std::logic_error);
  EXPECT_THROW(Dense(buffer, 4, 4, buffer, 64, 63, false, buffer, 64), std::logic_error);
  EXPECT_THROW(Dense(buffer, 4, 4, buffer, 64, -16, false, buffer, 64), std::logic_error);
  EXPECT_THROW(Dense(buffer, 4, 4, buffer, 15, 16, false, buffer, 16), std::logic_error) << "rows would overlap";
  EXPECT_THROW(Dense(buffer, 4, 4, buffer, 16, 16, false, buffer, 15), std::logic_error);
  EXPECT_THROW(DenseGated(buffer, 4, 4, buffer, 16, 16, buffer, 15, buffer, 16), std::logic_error);
  EXPECT_THROW(DenseWeightGradient(buffer, 16, 4, buffer, 15, 4, 16, buffer), std::logic_error);
  EXPECT_THROW(DenseWeightGradient(buffer, 16, 4, buffer, 16, 3, 16, buffer), std::logic_error);
}

TEST_P(DenseKernels, GateStopsWhatTheUnitStopped) {
  constexpr size_t kN = 48;
  std::vector<float> weights(16), in(4 * kN, 1.0F), gate(4 * kN, 1.0F), out(4 * kN);
  for (size_t i = 0; i < 16; ++i) weights[i] = static_cast<float>(i + 1);
  gate[3] = 0.0F;
  gate[2 * kN + 47] = -1.0F;
  DenseGated(weights.data(), 4, 4, in.data(), kN, kN, gate.data(), kN, out.data(), kN);
  for (size_t o = 0; o < 4; ++o) {
    for (size_t s = 0; s < kN; ++s) {
      const float sum = static_cast<float>(4 * (4 * o + 1) + 6);
      EXPECT_EQ(out[o * kN + s], gate[o * kN + s] > 0.0F ? sum : 0.0F);
    }
  }
}

}  // namespace
}  // namespace skyquilt::kernel
