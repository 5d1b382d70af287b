#include "core/metrics/ssim.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/metrics/check_shapes.h"

namespace skyquilt::metrics {
namespace {

constexpr int kWindow = 11;
constexpr int kHalf = kWindow / 2;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01;
constexpr double kC2 = 0.03 * 0.03;

// Window sums of: weight, a, b, a*a, b*b, a*b.
constexpr size_t kMoments = 6;
using Moments = std::array<double, kMoments>;

std::array<double, kWindow> GaussianWeights() {
  std::array<double, kWindow> weights{};
  double sum = 0.0;
  for (int i = 0; i < kWindow; ++i) {
    const double distance = i - kHalf;
    weights[static_cast<size_t>(i)] = std::exp(-distance * distance / (2.0 * kSigma * kSigma));
    sum += weights[static_cast<size_t>(i)];
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

double SsimOf(const Moments& sums) {
  const double scale = 1.0 / sums[0];
  const double mean_a = sums[1] * scale;
  const double mean_b = sums[2] * scale;
  const double variance_a = sums[3] * scale - mean_a * mean_a;
  const double variance_b = sums[4] * scale - mean_b * mean_b;
  const double covariance = sums[5] * scale - mean_a * mean_b;
  return (2.0 * mean_a * mean_b + kC1) * (2.0 * covariance + kC2) / ((mean_a * mean_a + mean_b * mean_b + kC1) * (variance_a + variance_b + kC2));
}

// Horizontal pass over one row of one channel, for the n_out columns whose window fits.
void FilterRow(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask, int y, int channel,
               const std::array<double, kWindow>& weights, std::vector<Moments>* pixels, std::vector<Moments>* out) {
  for (int x = 0; x < a.width; ++x) {
    Moments& pixel = (*pixels)[static_cast<size_t>(x)];
    if (mask != nullptr && *mask->At(x, y) == 0) {
      pixel = {};
      continue;
    }
    const double value_a = static_cast<double>(a.At(x, y)[channel]);
    const double value_b = static_cast<double>(b.At(x, y)[channel]);
    pixel = {1.0, value_a, value_b, value_a * value_a, value_b * value_b, value_a * value_b};
  }
  for (size_t x = 0; x < out->size(); ++x) {
    Moments sums{};
    for (size_t i = 0; i < kWindow; ++i) {
      for (size_t m = 0; m < kMoments; ++m) sums[m] += weights[i] * (*pixels)[x + i][m];
    }
    (*out)[x] = sums;
  }
}

}  // namespace

double Ssim(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask, image::ImageF* map) {
  CheckShapes(a, b, mask);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (map != nullptr) *map = image::ImageF(a.width, a.height, 1, std::numeric_limits<float>::quiet_NaN());
  if (a.width < kWindow || a.height < kWindow || a.channels < 1) return kNan;

  const std::array<double, kWindow> weights = GaussianWeights();
  const auto n_out = static_cast<size_t>(a.width - kWindow + 1);
  const auto n_channels = static_cast<size_t>(a.channels);
  std::vector<Moments> pixels(static_cast<size_t>(a.width));
  // The last 11 filtered rows of every channel; row y is in slot y mod 11.
  std::vector<std::array<std::vector<Moments>, kWindow>> filtered(n_channels);
  for (auto& rows : filtered) rows.fill(std::vector<Moments>(n_out));

  double total = 0.0;
  int64_t n_scored = 0;
  for (int y = 0; y < a.height; ++y) {
    for (size_t c = 0; c < n_channels; ++c) {
      FilterRow(a, b, mask, y, static_cast<int>(c), weights, &pixels, &filtered[c][static_cast<size_t>(y % kWindow)]);
    }
    const int centre_y = y - kHalf;
    if (centre_y < kHalf) continue;
    double row_total = 0.0;
    for (size_t x = 0; x < n_out; ++x) {
      const int centre_x = static_cast<int>(x) + kHalf;
      if (mask != nullptr && *mask->At(centre_x, centre_y) == 0) continue;
      double score = 0.0;
      for (size_t c = 0; c < n_channels; ++c) {
        Moments sums{};
        for (size_t i = 0; i < kWindow; ++i) {
          const Moments& row = filtered[c][(static_cast<size_t>(y - kWindow + 1) + i) % kWindow][x];
          for (size_t m = 0; m < kMoments; ++m) sums[m] += weights[i] * row[m];
        }
        score += SsimOf(sums);
      }
      score /= static_cast<double>(n_channels);
      row_total += score;
      ++n_scored;
      if (map != nullptr) *map->At(centre_x, centre_y) = static_cast<float>(score);
    }
    total += row_total;
  }
  return n_scored == 0 ? kNan : total / static_cast<double>(n_scored);
}

}  // namespace skyquilt::metrics
