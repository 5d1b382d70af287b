// One ray's loss: from what it was composed to, to the loss and its derivatives by that. Scattering them to the samples is the caller's.
#pragma once

#include <cstdint>

#include "worker/ray_batch.h"

namespace skyquilt::worker {

// Sums over the rays of a packet.
struct LossSums {
  double loss = 0.0, squared_error = 0.0;
  int64_t color_rays = 0;
  double shown = 0.0, log_share = 0.0;  // sums over rays (and colours) of fields with luminance
  int64_t solid_rays = 0;
};

// Live samples of a ray within its packet, and what the context shows in front of and behind them.
struct RayView {
  int64_t begin = 0, count = 0;
  float front_rgb[3] = {0, 0, 0}, front_transmittance = 1.0F;
  float behind_rgb[3] = {0, 0, 0};
  float background_share = 1.0F;
  // The same of the concealed rendering, in linear light; with luminance only.
  float front_light[3] = {0, 0, 0}, behind_light[3] = {0, 0, 0};
};

// What the samples of a ray came to: display values and the light that passes all of them.
struct ComposedRay {
  float rgb[3] = {0, 0, 0};
  float transmittance = 1.0F;
};

// Derivatives of the batch's mean loss; zero where the ray says nothing.
struct ComposedGradient {
  float rgb[3] = {0, 0, 0};
  float transmittance = 0.0F;
  float log_gain[3] = {0, 0, 0};  // by the logarithm of the photo's gains
};

// ray_share: 1 / rays of the batch. The loss itself is added to sums, not yet divided by the number of rays.
ComposedGradient LossOfRay(const BatchRay& ray, const RayView& view, const ComposedRay& composed, float ray_share, LossSums& sums);
// The same of a ray that is known to meet nothing, by its transmittance.
float LossOfEmptyRay(float transmittance, float ray_share, LossSums& sums);

}  // namespace skyquilt::worker
