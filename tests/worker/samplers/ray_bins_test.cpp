#include "worker/samplers/ray_bins.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/random.h"
#include "tests/support/gradient_check.h"
#include "worker/losses/interlevel_loss.h"

namespace skyquilt::worker {
namespace {

// Ascending edges from 0 to 1, some bins without length, and weights of sum at most 1.
struct Bins {
  std::vector<float> edges, weights;
};

Bins RandomBins(uint64_t seed, size_t n) {
  base::Random random(seed);
  Bins bins;
  for (size_t i = 0; i <= n; ++i) bins.edges.push_back(random.Uniform());
  bins.edges.front() = 0.0F;
  bins.edges.back() = 1.0F;
  std::sort(bins.edges.begin(), bins.edges.end());
  if (n > 3) bins.edges[2] = bins.edges[1];
  float left = 1.0F;
  for (size_t i = 0; i < n; ++i) {
    const float weight = random.Below(3) == 0 ? 0.0F : left * random.Uniform();
    bins.weights.push_back(weight);
    left -= weight;
  }
  return bins;
}

double Blurred(const Bins& bins, double half_width, double from, double to) {
  // The mean over [x - h, x + h] of the density, summed over many x.
  constexpr int kSteps = 20000;
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double x = from + (to - from) * (k + 0.5) / kSteps;
    for (size_t i = 0; i < bins.weights.size(); ++i) {
      const auto low = static_cast<double>(bins.edges[i]), high = static_cast<double>(bins.edges[i + 1]);
      const double overlap = std::max(0.0, std::min(high, x + half_width) - std::max(low, x - half_width));
      if (high == low && std::abs(low - x) < half_width) sum += static_cast<double>(bins.weights[i]) / (2.0 * half_width);
      if (high > low) sum += static_cast<double>(bins.weights[i]) * overlap / (high - low) / (2.0 * half_width);
    }
  }
  return sum * (to - from) / kSteps;
}

RC_GTEST_PROP(RayBins, ResampledEdgesAscendWithinTheBinsAndFollowTheirWeight, ()) {
  const auto n = *rc::gen::inRange<size_t>(1, 40);
  const Bins bins = RandomBins(*rc::gen::arbitrary<uint64_t>(), n);
  const float jitter = static_cast<float>(*rc::gen::inRange(0, 1000)) / 1000.0F;
  const double anneal = *rc::gen::element(0.0, 0.3, 1.0);
  std::vector<float> edges(1000);
  ResampleEdges(bins.edges, bins.weights, anneal, 0.0, jitter, edges);
  RC_ASSERT(std::is_sorted(edges.begin(), edges.end()));
  RC_ASSERT(edges.front() >= 0.0F && edges.back() <= 1.0F);
  double total = 0.0;
  const auto power = [&](float w) { return w > 0.0F ? std::pow(static_cast<double>(w), anneal) : 0.0; };
  for (const float w : bins.weights) total += power(w);
  if (total == 0.0) return;
  for (size_t i = 0; i < n; ++i) {
    if (bins.edges[i + 1] == bins.edges[i]) continue;
    const auto in_bin = std::count_if(edges.begin(), edges.end(), [&](float e) { return e > bins.edges[i] && e < bins.edges[i + 1]; });
    RC_ASSERT(std::abs(static_cast<double>(in_bin) / 1000.0 - power(bins.weights[i]) / total) < 0.004);
  }
}

TEST(RayBins, WithoutWeightOrWithAUniformShareEdgesAreEverywhere) {
  const std::vector<float> known = {0.0F, 0.1F, 0.2F, 1.0F}, none = {0.0F, 0.0F, 0.0F}, one = {0.0F, 1.0F, 0.0F};
  std::vector<float> edges(100);
  ResampleEdges(known, none, 1.0, 0.0, 0.5F, edges);
  for (size_t k = 0; k < edges.size(); ++k) EXPECT_NEAR(edges[k], (static_cast<float>(k) + 0.5F) / 100.0F, 1e-5F);
  ResampleEdges(known, one, 1.0, 0.2, 0.5F, edges);
  EXPECT_EQ(std::count_if(edges.begin(), edges.end(), [](float e) { return e > 0.2F; }), 16);
  EXPECT_EQ(std::count_if(edges.begin(), edges.end(), [](float e) { return e > 0.1F && e < 0.2F; }), 82);
}

TEST(RayBins, EvenEdgesMoveTogether) {
  std::vector<float> edges(5);
  EvenEdges(0.5F, edges);
  EXPECT_EQ(edges, (std::vector<float>{0.0F, 0.25F, 0.5F, 0.75F, 1.0F}));
  EvenEdges(0.9F, edges);
  EXPECT_EQ(edges.front(), 0.0F);
  EXPECT_NEAR(edges[1], 0.35F, 1e-6F);
  EXPECT_EQ(edges.back(), 1.0F);
}

TEST(RayBins, ContractedRaysAreEvenNearAndEvenInInverseDistanceFar) {
  const auto map = encoding::SpaceMap::Contracted({-50.0, -50.0, 0.0}, {50.0, 50.0, 20.0});
  const RaySpacing spacing(map, {10.0, 900.0});
  EXPECT_NEAR(spacing.Distance(0.0), 10.0, 1e-9);
  EXPECT_NEAR(spacing.Distance(1.0), 900.0, 1e-6);
  // Up to 50 m a share of the ray is so many metres everywhere; beyond, as much inverse distance.
  const double step = spacing.Distance(0.1) - spacing.Distance(0.0);
  EXPECT_NEAR(spacing.Distance(0.2) - spacing.Distance(0.1), step, 1e-9);
  EXPECT_NEAR(1.0 / spacing.Distance(0.8) - 1.0 / spacing.Distance(0.9), 1.0 / spacing.Distance(0.9) - 1.0 / spacing.Distance(1.0), 1e-9);
  for (double s = 0.0; s < 1.0; s += 0.01) EXPECT_LT(spacing.Distance(s), spacing.Distance(s + 0.01));
  const RaySpacing even(encoding::SpaceMap::Box({0.0, 0.0, 0.0}, {10.0, 10.0, 10.0}), {3.0, 7.0});
  EXPECT_NEAR(even.Distance(0.25), 4.0, 1e-12);
}

TEST(RayBins, WeightsHaveTheirGradient) {
  base::Random random(5);
  std::vector<double> tau, of_weight;
  for (int i = 0; i < 9; ++i) {
    tau.push_back(3.0 * random.UniformDouble());
    of_weight.push_back(random.UniformDouble() - 0.5);
  }
  tau[4] = 0.0;
  const auto loss = [&](const std::vector<double>& at) {
    std::vector<double> weights(at.size());
    WeightsOfTaus<double>(at, weights.data());
    double sum = 0.0;
    for (size_t i = 0; i < at.size(); ++i) sum += of_weight[i] * weights[i];
    return sum;
  };
  std::vector<double> weights(tau.size()), gradient(tau.size());
  const double transmittance = WeightsOfTaus<double>(tau, weights.data());
  WeightsBackward<double>(weights, transmittance, of_weight.data(), gradient.data());
  testing::ExpectGradient(loss, tau, gradient, 1e-6);
}

TEST(RayBins, BlurredWeightsAreThoseOfAMovingMean) {
  for (const uint64_t seed : {1U, 2U, 3U}) {
    const Bins bins = RandomBins(seed, 12);
    const std::vector<float> others = {0.0F, 0.05F, 0.2F, 0.2F, 0.6F, 0.95F, 1.0F};
    for (const double half_width : {0.003, 0.03, 0.4}) {
      InterlevelScratch scratch;
      std::vector<double> mass(others.size() - 1);
      BlurredWeights(bins.weights.size(), bins.edges.data(), bins.weights.data(), half_width, mass.size(), others.data(), scratch, mass.data());
      for (size_t k = 0; k < mass.size(); ++k) {
        EXPECT_NEAR(mass[k], Blurred(bins, half_width, static_cast<double>(others[k]), static_cast<double>(others[k + 1])), 2e-4)
            << seed << " " << half_width << " " << k;
      }
    }
  }
}

}  // namespace
}  // namespace skyquilt::worker
