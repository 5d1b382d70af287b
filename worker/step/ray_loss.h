// The loss of one ray and its derivatives by the ray's rendered colour and transmittance. The caller propagates them to the samples.
#pragma once

#include <cstdint>

#include "worker/rays/ray_batch.h"

namespace skyquilt::worker {

// Sums over the rays of a packet.
struct LossSums {
  double loss = 0.0, squared_error = 0.0;  // squared_error: of display values, over rays and colours
  int64_t color_rays = 0;                  // rays with a photo loss
  // With luminance only: display values of the rendering shown to people, over rays and colours; and log_share over solid rays (ConcealedRay).
  double shown = 0.0, log_share = 0.0;
  int64_t solid_rays = 0;
};

// The live samples of a ray (those that light reaches), and the colours of the context in front of and behind the block.
struct RayView {
  int64_t begin = 0, count = 0;  // live samples, within the packet
  float front_rgb[3] = {0, 0, 0}, front_transmittance = 1.0F;
  float behind_rgb[3] = {0, 0, 0};
  float background_share = 1.0F;  // transmittance of the context behind the block
  // Concealed rendering of the context in linear light; with luminance only.
  float front_light[3] = {0, 0, 0}, behind_light[3] = {0, 0, 0};
};

// A ray composited from its live samples: display values, and the transmittance behind the last one.
struct ComposedRay {
  float rgb[3] = {0, 0, 0};
  float transmittance = 1.0F;
};

// Derivatives of the batch's mean loss; zero where the ray has no loss.
struct ComposedGradient {
  float rgb[3] = {0, 0, 0};
  float transmittance = 0.0F;
  float log_gain[3] = {0, 0, 0};  // by the photo's log gains
};

// Photo loss. ray_share: 1 / rays of the batch. The loss is added to sums, not yet divided by the number of rays.
ComposedGradient LossOfRay(const BatchRay& ray, const RayView& view, const ComposedRay& composed, float ray_share, LossSums& sums);
// Loss of a ray that is known to meet no surface in the field. Returns the derivative by its transmittance.
float LossOfEmptyRay(float transmittance, float ray_share, LossSums& sums);

}  // namespace skyquilt::worker
