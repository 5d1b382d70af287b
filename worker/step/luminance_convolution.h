// Computes the factor Omega of the concealing field (core/brightness/luminance.h) for the samples of a packet: a convolution of width 7 over the
// luminance of neighbouring pixels, then a sigmoid (tidal-flat paper, eq. 12).
// Neighbours of a ray are the rays drawn next to it in its patch; beyond the ends of a patch its last ray is used. The partner of a sample on another
// ray is the sample nearest in distance: with an occupancy grid rays have different numbers of samples, and the published pairing by index would mix
// heights.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/field/hash_field.h"

namespace skyquilt::worker {

struct ConvolvedRay {
  int64_t begin = 0, count = 0;  // its samples
  int64_t patch = 0;             // rays of one patch follow each other
};

class LuminanceConvolution {
 public:
  // Finds the partners of n samples. t: distances of the samples, ascending along each ray.
  void Pair(std::span<const ConvolvedRay> rays, const float* t, int64_t n);
  // Computes omega(). luminance: per sample; weights: taps, then bias.
  void Forward(const float* luminance, const std::array<float, field::kLuminanceTaps + 1>& weights);
  const std::vector<float>& omega() const { return omega_; }
  // Writes luminance_gradient (per sample) and adds to weight_gradient (taps, then bias).
  void Backward(const float* luminance, const std::array<float, field::kLuminanceTaps + 1>& weights, const float* omega_gradient,
                float* luminance_gradient, float* weight_gradient) const;

 private:
  std::vector<int32_t> partner_;  // [sample][tap]
  std::vector<float> omega_;
};

}  // namespace skyquilt::worker
