// The loss of a ray when the survey has a concealing field (core/brightness/luminance.h). A ray then has two renderings, plain and concealed. One of
// them is compared with the photos. The other one is shown to people, and its mean brightness should reach the target.
#pragma once

#include <cstddef>
#include <span>

#include "worker/step/ray_loss.h"

namespace skyquilt::worker {

// The two renderings of a ray's samples. For shares see core/render/concealed.h.
struct ConcealedRay {
  ComposedRay plain;
  float light[3] = {0, 0, 0};  // concealed rendering, linear light
  float shown_weight = 0.0F;   // sum of compositing weight times share
  float log_share = 0.0F;      // logarithm of the mean share by compositing weight; only when solid
  bool solid = false;          // the ray is opaque enough for a meaningful log_share
  int64_t patch = 0;           // successive rays of the same patch are neighbours
};

// Values shared by all rays of a step.
struct ConcealedTask {
  bool toned = true;           // the photo loss is that of toned values; false: of display values
  bool under = false;          // true: photos are compared with the concealed rendering; false: with the plain rendering
  float mean_share = 1.0F;     // share of the background's light in the concealed rendering
  float mean_log_gain = 0.0F;  // goal of log_share
  float pull = 0.0F;           // derivative of the mean brightness loss by one colour of one ray
};

struct ConcealedGradient {
  ComposedGradient plain;
  float light[3] = {0, 0, 0};        // by ConcealedRay::light, propagated to density, colour and Omega
  float share_light[3] = {0, 0, 0};  // by ConcealedRay::light, propagated to Omega only
  float log_share = 0.0F;            // by ConcealedRay::log_share, from LossOfShares
};

// Derivative of the loss weight * (mean_shown - target)^2 by one colour of one ray; 0 for weight 0. mean_shown, target: display values.
float MeanBrightnessPull(float weight, double mean_shown, double target);

// Loss of a ray of the photo loss and the mean brightness loss together; arguments as LossOfRay.
ConcealedGradient LossOfConcealedRay(const BatchRay& ray, const RayView& view, const ConcealedRay& composed, const ConcealedTask& task,
                                     float ray_share, LossSums& sums);
// Adds the losses that keep log_share of ray k near that of its neighbours and near mean_log_gain. Returns the derivative of the sum over all rays by
// log_share of ray k, not yet multiplied by ray_share.
float LossOfShares(std::span<const ConcealedRay> rays, size_t k, float mean_log_gain, LossSums& sums);

}  // namespace skyquilt::worker
