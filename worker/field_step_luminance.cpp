// From the samples of fields with hidden light (core/brightness/luminance.h) to the loss of every ray and back.
#include <algorithm>
#include <cmath>

#include "core/image/srgb.h"
#include "core/render/composite.h"
#include "worker/field_step_worker.h"
#include "worker/losses/loss.h"

namespace skyquilt::worker {
namespace {

constexpr float kSolidOpacity = 0.2F;

render::Concealing ConcealingOf(const brightness::Luminance& luminance) {
  return luminance.product ? render::Concealing::kProduct : render::Concealing::kGain;
}

}  // namespace

// Omega of the samples, their linear light, and what all rays come to.
void FieldStep::ComposeConcealed(const RayBatch& batch, const Packet& packet, int64_t n, Worker& w) const {
  const field::Activations& a = w.a;
  w.rays.clear();
  for (size_t k = 0; k < w.views.size(); ++k) {
    w.rays.push_back({w.views[k].begin, w.views[k].count, batch.rays[static_cast<size_t>(packet.first_ray) + k].patch});
  }
  const float* luminance = a.color_raw + 3 * a.stride;
  w.luminance.Pair(w.rays, batch.t.data() + packet.begin, n);
  w.luminance.Forward(luminance, weights_.luminance);
  for (auto* v : {&w.share, &w.share_gradient, &w.omega_gradient}) Grow(*v, static_cast<size_t>(n));
  for (auto* v : {&w.light, &w.light_slope}) Grow(*v, 3 * a.stride);
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = c * a.stride; i < c * a.stride + static_cast<size_t>(n); ++i) {
      w.light[i] = image::LinearFromSrgb(w.rgb[i]);
      w.light_slope[i] = image::LinearSlope(w.rgb[i]);
    }
  }
  w.concealed.clear();
  for (size_t k = 0; k < w.views.size(); ++k) w.concealed.push_back(ComposeConcealedRay(w.views[k], w.rays[k].patch, w));
}

ConcealedRay FieldStep::ComposeConcealedRay(const RayView& view, int64_t patch, Worker& w) const {
  const auto begin = static_cast<size_t>(view.begin), count = static_cast<size_t>(view.count);
  ConcealedRay composed;
  composed.patch = patch;
  composed.plain = Compose(view, w);
  render::LightShares(ConcealingOf(luminance_), static_cast<int>(count), w.luminance.omega().data() + begin, w.share.data() + begin);
  for (size_t i = 0; i < count; ++i) {
    const float seen = w.weight[begin + i] * w.share[begin + i];
    composed.shown_weight += seen;
    for (size_t c = 0; c < 3; ++c) composed.light[c] += seen * w.light[c * w.a.stride + begin + i];
  }
  const float transmittance = composed.plain.transmittance;
  composed.solid = transmittance < 1.0F - kSolidOpacity && composed.shown_weight > 0.0F;
  if (composed.solid) composed.log_share = std::log(composed.shown_weight / (1.0F - transmittance));
  return composed;
}

FieldStep::PacketResult FieldStep::ConcealAndLoss(const RayBatch& batch, const Packet& packet, int64_t n, float ray_share, double distortion,
                                                  float* network_gradient, Worker& w) {
  PacketResult result;
  ComposeConcealed(batch, packet, n, w);
  ConcealedTask task;
  task.under = luminance_.mode == brightness::LuminanceMode::kUnder;
  task.mean_share = static_cast<float>(std::exp(state_.mean_log_gain));
  task.mean_log_gain = static_cast<float>(state_.mean_log_gain);
  // Only the context looks after the mean; blocks keep to what it found.
  task.pull = MeanBrightnessPull(controls_mean_ ? kLossWeights.mean_brightness : 0.0F, state_.mean_shown, luminance_.target);
  for (size_t k = 0; k < w.views.size(); ++k) {
    const size_t ray = static_cast<size_t>(packet.first_ray) + k;
    const BatchRay& r = batch.rays[ray];
    const RayView& view = w.views[k];
    const ConcealedRay& composed = w.concealed[k];
    ConcealedGradient gradient;
    w.weight_gradient.assign(static_cast<size_t>(view.count), 0.0F);
    if (r.ray.empty) {
      gradient.plain.transmittance = LossOfEmptyRay(composed.plain.transmittance, ray_share, result.sums);
    } else {
      gradient = LossOfConcealedRay(r, view, composed, task, ray_share, result.sums);
      KeepGainGradient(ray, gradient.plain);
      gradient.log_share = LossOfShares(w.concealed, k, task.mean_log_gain, result.sums) * ray_share;
      if (composed.solid) {
        result.sums.log_share += static_cast<double>(composed.log_share);
        ++result.sums.solid_rays;
      }
      if (distortion > 0.0 && view.count > 0) AddDistortion(batch, packet, view, ray_share, distortion, w, result.sums);
    }
    ScatterConcealed(view, composed, gradient, w);
  }
  w.luminance.Backward(w.a.color_raw + 3 * w.a.stride, weights_.luminance, w.omega_gradient.data(), w.a.color_gradient + 3 * w.a.stride,
                       network_gradient + field_.LuminanceOffset());
  FinishGradients(n, w);
  return result;
}

// Adds to w.weight_gradient what is there already of the distortion loss.
void FieldStep::ScatterConcealed(const RayView& view, const ConcealedRay& composed, const ConcealedGradient& gradient, Worker& w) const {
  field::Activations& a = w.a;
  const auto begin = static_cast<size_t>(view.begin), count = static_cast<size_t>(view.count);
  const float* weights = w.weight.data() + begin;
  const float per_shown = composed.shown_weight > 0.0F ? gradient.log_share / composed.shown_weight : 0.0F;
  for (size_t i = 0; i < count; ++i) {
    float all = 0.0F, omega_only = per_shown;
    for (size_t c = 0; c < 3; ++c) {
      const float light = w.light[c * a.stride + begin + i];
      all += gradient.light[c] * light;
      omega_only += gradient.share_light[c] * light;
    }
    w.weight_gradient[i] += w.share[begin + i] * all;
    w.share_gradient[begin + i] = weights[i] * (all + omega_only);
  }
  render::LightSharesBackward(ConcealingOf(luminance_), static_cast<int>(count), w.luminance.omega().data() + begin, w.share.data() + begin,
                              w.share_gradient.data() + begin, w.omega_gradient.data() + begin);
  ScatterComposed(view, composed.plain, gradient.plain, w.weight_gradient.data(), w);
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < count; ++i) {
      a.color_gradient[c * a.stride + begin + i] += gradient.light[c] * weights[i] * w.share[begin + i] * w.light_slope[c * a.stride + begin + i];
    }
  }
}

}  // namespace skyquilt::worker
