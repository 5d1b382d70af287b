// Omega of a packet's samples: a convolution of width 7 over the luminance of neighbouring pixels, sample by sample, then a sigmoid
// (tidal-flat paper, eq. 12). Neighbours are the rays that were drawn beside a ray; a sample's partner on another ray is the one nearest in
// distance, because occupancy leaves rays of different lengths and the published pairing by sample index would then mix heights. Past the end of
// a patch its last ray stands in.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/field/hash_field.h"

namespace skyquilt::worker {

struct ConvolvedRay {
  int64_t begin = 0, count = 0;  // samples
  int64_t patch = 0;             // rays of one patch stand together
};

class LuminanceConvolution {
 public:
  // t: distances of the samples, ascending along each ray.
  void Pair(std::span<const ConvolvedRay> rays, const float* t, int64_t n);
  // luminance: per sample; weights: taps, then bias.
  void Forward(const float* luminance, const std::array<float, field::kLuminanceTaps + 1>& weights);
  const std::vector<float>& omega() const { return omega_; }
  // Writes luminance_gradient, adds to weight_gradient (taps, then bias).
  void Backward(const float* luminance, const std::array<float, field::kLuminanceTaps + 1>& weights, const float* omega_gradient,
                float* luminance_gradient, float* weight_gradient) const;

 private:
  std::vector<int32_t> partner_;  // [sample][tap]
  std::vector<float> omega_;
};

}  // namespace skyquilt::worker
