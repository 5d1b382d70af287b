#include "worker/step/packet_concealed.h"

#include <cmath>

#include "core/image/srgb.h"
#include "core/render/concealed.h"
#include "worker/losses/loss.h"

namespace skyquilt::worker {
namespace {

// A ray below this opacity has no meaningful mean share.
constexpr float kSolidOpacity = 0.2F;

render::Concealing ConcealingOf(const brightness::Luminance& luminance) {
  return luminance.product ? render::Concealing::kProduct : render::Concealing::kGain;
}

}  // namespace

void PacketConcealed::Add(PacketSamples& s, float* network_gradient, LossSums& sums) {
  Compose(s);
  const ConcealedTask task = TaskOfRays();
  for (size_t k = 0; k < s.views.size(); ++k) {
    const BatchRay& r = s.Ray(k);
    const RayView& view = s.views[k];
    const ConcealedRay& composed = concealed_[k];
    ConcealedGradient gradient;
    weight_gradient_.assign(static_cast<size_t>(view.count), 0.0F);
    if (r.ray.empty) {
      gradient.plain.transmittance = LossOfEmptyRay(composed.plain.transmittance, s.step->ray_share, sums);
    } else {
      gradient = LossOfConcealedRay(r, view, composed, task, s.step->ray_share, sums);
      s.KeepGainGradient(k, gradient.plain);
      gradient.log_share = LossOfShares(concealed_, k, task.mean_log_gain, sums) * s.step->ray_share;
      if (composed.solid) {
        sums.log_share += static_cast<double>(composed.log_share);
        ++sums.solid_rays;
      }
      if (PacketDistortion::Wanted(s, k)) distortion_.Add(s, k, weight_gradient_.data(), sums);
    }
    Scatter(s, view, composed, gradient);
  }
  const size_t luminance = 3 * s.a.stride;
  convolution_.Backward(s.a.color_raw + luminance, s.step->weights.luminance, omega_gradient_.data(), s.a.color_gradient + luminance,
                        network_gradient + shared_.field.LuminanceOffset());
}

void PacketConcealed::Compose(PacketSamples& s) {
  const size_t live = static_cast<size_t>(s.live), stride = s.a.stride;
  rays_.clear();
  for (size_t k = 0; k < s.views.size(); ++k) rays_.push_back({s.views[k].begin, s.views[k].count, s.Ray(k).patch});
  convolution_.Pair(rays_, s.Distances(), s.live);
  convolution_.Forward(s.a.color_raw + 3 * stride, s.step->weights.luminance);
  for (auto* v : {&share_, &share_gradient_, &omega_gradient_}) Grow(*v, live);
  for (auto* v : {&light_, &light_slope_}) Grow(*v, 3 * stride);
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = c * stride; i < c * stride + live; ++i) {
      light_[i] = image::LinearFromSrgb(s.rgb[i]);
      light_slope_[i] = image::LinearSlope(s.rgb[i]);
    }
  }
  concealed_.clear();
  for (size_t k = 0; k < s.views.size(); ++k) concealed_.push_back(ComposeRay(s, k));
}

ConcealedRay PacketConcealed::ComposeRay(PacketSamples& s, size_t view) {
  const auto begin = static_cast<size_t>(rays_[view].begin), count = static_cast<size_t>(rays_[view].count);
  ConcealedRay composed;
  composed.patch = rays_[view].patch;
  composed.plain = s.Compose(s.views[view]);
  render::LightShares(ConcealingOf(shared_.luminance), static_cast<int>(count), convolution_.omega().data() + begin, share_.data() + begin);
  for (size_t i = 0; i < count; ++i) {
    const float seen = s.weight[begin + i] * share_[begin + i];
    composed.shown_weight += seen;
    for (size_t c = 0; c < 3; ++c) composed.light[c] += seen * light_[c * s.a.stride + begin + i];
  }
  const float transmittance = composed.plain.transmittance;
  composed.solid = transmittance < 1.0F - kSolidOpacity && composed.shown_weight > 0.0F;
  if (composed.solid) composed.log_share = std::log(composed.shown_weight / (1.0F - transmittance));
  return composed;
}

ConcealedTask PacketConcealed::TaskOfRays() const {
  ConcealedTask task;
  task.toned = shared_.luminance.toned;
  task.under = shared_.luminance.mode == brightness::LuminanceMode::kUnder;
  task.mean_share = static_cast<float>(std::exp(shared_.means.mean_log_gain));
  task.mean_log_gain = static_cast<float>(shared_.means.mean_log_gain);
  // Only the context controls the mean brightness; blocks keep the context's.
  task.pull = MeanBrightnessPull(shared_.controls_mean ? kLossWeights.mean_brightness : 0.0F, shared_.means.mean_shown, shared_.luminance.target);
  return task;
}

// weight_gradient_ already holds the gradient of the distortion loss, or zeros.
void PacketConcealed::Scatter(PacketSamples& s, const RayView& view, const ConcealedRay& composed, const ConcealedGradient& gradient) {
  const size_t begin = static_cast<size_t>(view.begin), count = static_cast<size_t>(view.count), stride = s.a.stride;
  const float* weights = s.weight.data() + begin;
  const float per_shown = composed.shown_weight > 0.0F ? gradient.log_share / composed.shown_weight : 0.0F;
  for (size_t i = 0; i < count; ++i) {
    float all = 0.0F, omega_only = per_shown;
    for (size_t c = 0; c < 3; ++c) {
      const float light = light_[c * stride + begin + i];
      all += gradient.light[c] * light;
      omega_only += gradient.share_light[c] * light;
    }
    weight_gradient_[i] += share_[begin + i] * all;
    share_gradient_[begin + i] = weights[i] * (all + omega_only);
  }
  render::LightSharesBackward(ConcealingOf(shared_.luminance), static_cast<int>(count), convolution_.omega().data() + begin, share_.data() + begin,
                              share_gradient_.data() + begin, omega_gradient_.data() + begin);
  s.Scatter(view, composed.plain, gradient.plain, weight_gradient_.data());
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < count; ++i) {
      s.a.color_gradient[c * stride + begin + i] += gradient.light[c] * weights[i] * share_[begin + i] * light_slope_[c * stride + begin + i];
    }
  }
}

}  // namespace skyquilt::worker
