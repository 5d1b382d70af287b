#include "worker/step/luminance_convolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/render/concealed.h"
#include "tests/support/gradient_check.h"

namespace skyquilt::worker {
namespace {

constexpr auto kTaps = static_cast<size_t>(field::kLuminanceTaps);
using Weights = std::array<float, field::kLuminanceTaps + 1>;

// Two patches, one of them with a ray that has no samples.
const std::vector<ConvolvedRay> kRays = {{0, 3, 0}, {3, 2, 0}, {5, 0, 0}, {5, 4, 0}, {9, 2, 1}, {11, 1, 1}};
const std::vector<float> kDistances = {10.0F, 11.0F, 12.0F, 10.4F, 11.4F, 9.9F, 10.9F, 11.9F, 12.9F, 30.0F, 31.0F, 30.6F};

TEST(LuminanceConvolution, IsTheIdentityOverEqualNeighbours) {
  LuminanceConvolution convolution;
  convolution.Pair(kRays, kDistances.data(), 12);
  Weights weights{};
  weights.fill(1.0F / 7.0F);
  weights[kTaps] = 0.0F;
  const std::vector<float> luminance(12, 0.7F);
  convolution.Forward(luminance.data(), weights);
  for (const float omega : convolution.omega()) EXPECT_NEAR(omega, 1.0F / (1.0F + std::exp(-0.7F)), 1e-6F);
}

TEST(LuminanceConvolution, PairsByDistanceAndStaysInItsPatch) {
  LuminanceConvolution convolution;
  convolution.Pair(kRays, kDistances.data(), 12);
  // Only the neighbour on the right counts.
  Weights weights{};
  weights[kTaps / 2 + 1] = 1.0F;
  std::vector<float> luminance;
  luminance.reserve(12);
  for (int i = 0; i < 12; ++i) luminance.push_back(0.1F * static_cast<float>(i));
  convolution.Forward(luminance.data(), weights);
  const auto logit = [&](size_t s) { return std::log(convolution.omega()[s] / (1.0F - convolution.omega()[s])); };
  EXPECT_NEAR(logit(0), 0.3F, 1e-4F);  // 10.0 next to 10.4
  EXPECT_NEAR(logit(2), 0.4F, 1e-4F);  // 12.0 next to 11.4
  EXPECT_NEAR(logit(4), 0.4F, 1e-4F);  // the ray on its right has no samples: itself
  EXPECT_NEAR(logit(8), 0.8F, 1e-4F);  // last of its patch
  EXPECT_NEAR(logit(10), 1.1F, 1e-4F);
}

TEST(LuminanceConvolution, GradientsMatchFiniteDifferences) {
  base::Random random(3);
  std::vector<double> x;
  x.reserve(12 + 8);
  for (int i = 0; i < 12 + 8; ++i) x.push_back(static_cast<double>(random.Uniform()) - 0.5);
  std::vector<float> wanted;
  wanted.reserve(12);
  for (int i = 0; i < 12; ++i) wanted.push_back(random.Uniform());
  LuminanceConvolution convolution;
  convolution.Pair(kRays, kDistances.data(), 12);
  const auto run = [&](const std::vector<double>& at) {
    const std::vector<float> luminance(at.begin(), at.begin() + 12);
    Weights weights{};
    std::copy(at.begin() + 12, at.end(), weights.begin());
    convolution.Forward(luminance.data(), weights);
    double value = 0.0;
    for (size_t s = 0; s < 12; ++s) value += static_cast<double>(wanted[s] * convolution.omega()[s]);
    return value;
  };
  run(x);
  const std::vector<float> luminance(x.begin(), x.begin() + 12);
  Weights weights{};
  std::copy(x.begin() + 12, x.end(), weights.begin());
  std::vector<float> luminance_gradient(12), weight_gradient(8, 0.0F);
  convolution.Backward(luminance.data(), weights, wanted.data(), luminance_gradient.data(), weight_gradient.data());
  std::vector<double> analytic(luminance_gradient.begin(), luminance_gradient.end());
  analytic.insert(analytic.end(), weight_gradient.begin(), weight_gradient.end());
  testing::ExpectGradient(run, x, analytic, 1e-3);  // values are single precision
}

TEST(LightShares, GradientsMatchFiniteDifferences) {
  for (const render::Concealing concealing : {render::Concealing::kGain, render::Concealing::kProduct}) {
    const std::vector<double> omega = {0.9, 0.3, 0.6, 0.05, 0.99}, wanted = {0.4, -1.0, 0.7, 2.0, 0.1};
    const auto run = [&](const std::vector<double>& at) {
      std::vector<double> share(5);
      render::LightShares(concealing, 5, at.data(), share.data());
      double value = 0.0;
      for (size_t i = 0; i < 5; ++i) value += wanted[i] * share[i];
      return value;
    };
    std::vector<double> share(5), gradient(5);
    render::LightShares(concealing, 5, omega.data(), share.data());
    render::LightSharesBackward(concealing, 5, omega.data(), share.data(), wanted.data(), gradient.data());
    testing::ExpectGradient(run, omega, gradient);
  }
}

}  // namespace
}  // namespace skyquilt::worker
