// One ray's loss in fields with concealing field (core/brightness/luminance.h): two renderings from one density, of which the photos judge one and
// the wish for a given mean brightness the other.
#pragma once

#include <cstddef>
#include <span>

#include "worker/ray_loss.h"

namespace skyquilt::worker {

// What the two renderings of a ray's samples came to.
struct ConcealedRay {
  ComposedRay plain;
  float light[3] = {0, 0, 0};  // concealed, linear
  float shown_weight = 0.0F;   // sum of weights times shares
  float log_share = 0.0F;      // logarithm of the mean share, weighted by what is seen
  bool solid = false;          // enough is seen for that to mean something
  int64_t patch = 0;           // rays of one patch are neighbours
};

// What all rays of a step have in common.
struct ConcealedTask {
  bool under = false;          // the photos show the concealed rendering and the plain one is the wish's; else the other way round
  float mean_share = 1.0F;     // of the light behind everything
  float mean_log_gain = 0.0F;  // what log shares stay near
  float pull = 0.0F;           // derivative of the wish for a mean brightness by one colour of one ray
};

struct ConcealedGradient {
  ComposedGradient plain;
  float light[3] = {0, 0, 0};        // of the concealed rendering, all the way to density and colour
  float share_light[3] = {0, 0, 0};  // of the concealed rendering, for Omega alone
  float log_share = 0.0F;            // of the logarithm of the mean share: from LossOfShares, 0 without it
};

// Derivative of the wish for a mean brightness by one colour of one ray. weight: 0 lets the brightness go where it will. mean_shown and target:
// display values.
float MeanBrightnessPull(float weight, double mean_shown, double target);

// The photo's loss and the wish of a ray of colour; arguments as LossOfRay.
ConcealedGradient LossOfConcealedRay(const BatchRay& ray, const RayView& view, const ConcealedRay& composed, const ConcealedTask& task,
                                     float ray_share, LossSums& sums);
// Adds what ray k's log share costs for being unlike its neighbours and far from the mean (a logarithm, too); returns the derivative of the sum over
// all rays by it, not yet multiplied by ray_share.
float LossOfShares(std::span<const ConcealedRay> rays, size_t k, float mean_log_gain, LossSums& sums);

}  // namespace skyquilt::worker
