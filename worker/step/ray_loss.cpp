#include "worker/step/ray_loss.h"

#include "core/brightness/exposure.h"
#include "worker/losses/loss.h"
#include "worker/losses/photo_loss.h"

namespace skyquilt::worker {

ComposedGradient LossOfRay(const BatchRay& ray, const RayView& view, const ComposedRay& composed, float ray_share, LossSums& sums) {
  ComposedGradient gradient;
  const float weight = kPhotoLossWeight[ray.ray.level];
  for (size_t c = 0; c < 3; ++c) {
    const float behind = view.behind_rgb[c] + view.background_share * ray.background[c];
    const float shown = view.front_rgb[c] + view.front_transmittance * (composed.rgb[c] + composed.transmittance * behind);
    const auto [value, slope, log_gain_slope] = brightness::Expose(shown, ray.ray.exposure[c]);
    const PhotoLoss<float> photo = SquaredPhotoLoss(value, ray.ray.target_srgb[c]);
    sums.squared_error += photo.squared_error;
    if (!photo.counts) continue;
    sums.loss += static_cast<double>(weight) * photo.value;
    const float photo_gradient = weight * photo.gradient * ray_share;
    gradient.log_gain[c] = photo_gradient * log_gain_slope;
    gradient.rgb[c] = photo_gradient * slope * view.front_transmittance;
    gradient.transmittance += gradient.rgb[c] * behind;
  }
  ++sums.color_rays;
  return gradient;
}

float LossOfEmptyRay(float transmittance, float ray_share, LossSums& sums) {
  if constexpr (kLossWeights.emptiness == 0.0F) return 0.0F;
  const Loss<float> emptiness = EmptinessLoss(kLossWeights.emptiness, transmittance);
  sums.loss += static_cast<double>(emptiness.value);
  return emptiness.gradient * ray_share;
}

}  // namespace skyquilt::worker
