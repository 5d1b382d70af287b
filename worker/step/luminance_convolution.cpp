#include "worker/step/luminance_convolution.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

constexpr int64_t kTapReach = field::kLuminanceTaps / 2;
constexpr auto kTaps = static_cast<size_t>(field::kLuminanceTaps);
// Keeps Omega above 0, so that its inverse is finite.
constexpr float kLargestLogit = 16.0F;

}  // namespace

void LuminanceConvolution::Pair(std::span<const ConvolvedRay> rays, const float* t, int64_t n) {
  partner_.resize(static_cast<size_t>(n) * kTaps);
  const auto n_rays = static_cast<int64_t>(rays.size());
  for (int64_t k = 0; k < n_rays; ++k) {
    const ConvolvedRay& ray = rays[static_cast<size_t>(k)];
    for (int64_t tap = -kTapReach; tap <= kTapReach; ++tap) {
      // The farthest ray with samples in this direction, at most |tap| rays away and in the same patch.
      int64_t other = k;
      for (int64_t step = 1; step <= std::abs(tap); ++step) {
        const int64_t next = k + (tap < 0 ? -step : step);
        if (next < 0 || next >= n_rays || rays[static_cast<size_t>(next)].patch != ray.patch) break;
        if (rays[static_cast<size_t>(next)].count > 0) other = next;
      }
      const ConvolvedRay& neighbour = rays[static_cast<size_t>(other)];
      int64_t at = neighbour.begin;
      const int64_t last = neighbour.begin + neighbour.count - 1;
      for (int64_t s = ray.begin; s < ray.begin + ray.count; ++s) {
        while (at < last && std::abs(t[at + 1] - t[s]) <= std::abs(t[at] - t[s])) ++at;
        partner_[static_cast<size_t>(s) * kTaps + static_cast<size_t>(tap + kTapReach)] = static_cast<int32_t>(other == k ? s : at);
      }
    }
  }
}

void LuminanceConvolution::Forward(const float* luminance, const std::array<float, field::kLuminanceTaps + 1>& weights) {
  omega_.resize(partner_.size() / kTaps);
  for (size_t s = 0; s < omega_.size(); ++s) {
    float logit = weights[kTaps];
    for (size_t tap = 0; tap < kTaps; ++tap) logit += weights[tap] * luminance[partner_[s * kTaps + tap]];
    omega_[s] = 1.0F / (1.0F + std::exp(-std::clamp(logit, -kLargestLogit, kLargestLogit)));
  }
}

void LuminanceConvolution::Backward(const float* luminance, const std::array<float, field::kLuminanceTaps + 1>& weights, const float* omega_gradient,
                                    float* luminance_gradient, float* weight_gradient) const {
  std::fill_n(luminance_gradient, omega_.size(), 0.0F);
  for (size_t s = 0; s < omega_.size(); ++s) {
    const float logit_gradient = omega_gradient[s] * omega_[s] * (1.0F - omega_[s]);
    weight_gradient[kTaps] += logit_gradient;
    for (size_t tap = 0; tap < kTaps; ++tap) {
      const int32_t partner = partner_[s * kTaps + tap];
      luminance_gradient[partner] += weights[tap] * logit_gradient;
      weight_gradient[tap] += luminance[partner] * logit_gradient;
    }
  }
}

}  // namespace skyquilt::worker
