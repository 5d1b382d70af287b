#include "worker/step/concealed_ray_loss.h"

#include <algorithm>

#include "core/brightness/exposure.h"
#include "core/image/srgb.h"
#include "worker/losses/loss.h"
#include "worker/losses/photo_loss.h"

namespace skyquilt::worker {
namespace {

// The display value that a photo records of linear light, with its derivatives by the light and by the log gain.
brightness::Exposed RecordLight(float light, const brightness::Exposure& exposure) {
  const float recorded = exposure.gain * std::max(light, 0.0F);
  const float slope = image::SrgbSlope(recorded);
  return {image::SrgbFromLinear(recorded), slope * exposure.gain, slope * recorded};
}

}  // namespace

float MeanBrightnessPull(float weight, double mean_shown, double target) {
  if (weight == 0.0F) return 0.0F;
  return MeanLoss(weight, static_cast<float>(mean_shown - target)).gradient / 3.0F;  // the mean of a ray is over three colours
}

ConcealedGradient LossOfConcealedRay(const BatchRay& ray, const RayView& view, const ConcealedRay& composed, const ConcealedTask& task,
                                     float ray_share, LossSums& sums) {
  ConcealedGradient gradient;
  const float weight = kPhotoLossWeight[ray.ray.level];
  for (size_t c = 0; c < 3; ++c) {
    const float behind = view.behind_rgb[c] + view.background_share * ray.background[c];
    const float plain = view.front_rgb[c] + view.front_transmittance * (composed.plain.rgb[c] + composed.plain.transmittance * behind);
    const float behind_light = view.behind_light[c] + view.background_share * task.mean_share * image::LinearFromSrgb(ray.background[c]);
    const float light = view.front_light[c] + view.front_transmittance * (composed.light[c] + composed.plain.transmittance * behind_light);
    const auto [value, slope, log_gain_slope] = task.under ? RecordLight(light, ray.ray.exposure[c]) : brightness::Expose(plain, ray.ray.exposure[c]);
    const PhotoLoss<float> photo = task.toned ? TonedPhotoLoss(value, ray.ray.target_srgb[c]) : SquaredPhotoLoss(value, ray.ray.target_srgb[c]);
    sums.squared_error += photo.squared_error;
    float recorded_gradient = 0.0F;
    if (photo.counts) {
      sums.loss += static_cast<double>(weight) * photo.value;
      const float toned_gradient = weight * photo.gradient * ray_share;
      recorded_gradient = toned_gradient * slope * view.front_transmittance;
      gradient.plain.log_gain[c] = toned_gradient * log_gain_slope;
    }
    const float shown = task.under ? plain : image::SrgbFromLinear(std::max(light, 0.0F));
    sums.shown += static_cast<double>(shown);
    if (task.under) {
      gradient.plain.rgb[c] = task.pull * view.front_transmittance * ray_share;
      gradient.light[c] = recorded_gradient;
      gradient.plain.transmittance += gradient.plain.rgb[c] * behind + recorded_gradient * behind_light;
    } else {
      gradient.plain.rgb[c] = recorded_gradient;
      gradient.share_light[c] = task.pull * image::SrgbSlope(std::max(light, 0.0F)) * view.front_transmittance * ray_share;
      gradient.plain.transmittance += recorded_gradient * behind;
    }
  }
  ++sums.color_rays;
  return gradient;
}

float LossOfShares(std::span<const ConcealedRay> rays, size_t k, float mean_log_gain, LossSums& sums) {
  const ConcealedRay& ray = rays[k];
  if (!ray.solid) return 0.0F;
  float gradient = 0.0F;
  if constexpr (kLossWeights.mean_share > 0.0F) {
    const Loss<float> mean = MeanLoss(kLossWeights.mean_share, ray.log_share - mean_log_gain);
    sums.loss += static_cast<double>(mean.value);
    gradient = mean.gradient;
  }
  if constexpr (kLossWeights.smoothness > 0.0F) {
    for (const size_t other : {k - 1, k + 1}) {  // k - 1 of the first ray wraps around and is skipped
      if (other >= rays.size() || !rays[other].solid || rays[other].patch != ray.patch) continue;
      AddSmoothnessLoss(kLossWeights.smoothness, ray.log_share, rays[other].log_share, &sums.loss, &gradient);
    }
  }
  return gradient;
}

}  // namespace skyquilt::worker
