// With a concealing field (core/brightness/luminance.h): computes the loss of every ray from its samples, and the gradients by these.
#include <algorithm>
#include <cmath>

#include "core/image/srgb.h"
#include "core/render/composite.h"
#include "worker/losses/loss.h"
#include "worker/step/packet_trainer.h"

namespace skyquilt::worker {
namespace {

// A ray below this opacity has no meaningful mean share.
constexpr float kSolidOpacity = 0.2F;

render::Concealing ConcealingOf(const brightness::Luminance& luminance) {
  return luminance.product ? render::Concealing::kProduct : render::Concealing::kGain;
}

}  // namespace

// Computes Omega and linear light of the samples, and both renderings of every ray.
void PacketTrainer::ComposeConcealed() {
  const auto live = static_cast<size_t>(live_);
  rays_.clear();
  for (size_t k = 0; k < views_.size(); ++k) {
    rays_.push_back({views_[k].begin, views_[k].count, Ray(k).patch});
  }
  const float* luminance = a_.color_raw + 3 * a_.stride;
  convolution_.Pair(rays_, step_->batch.t.data() + packet_->begin, live_);
  convolution_.Forward(luminance, shared_.weights.luminance);
  for (auto* v : {&share_, &share_gradient_, &omega_gradient_}) Grow(*v, live);
  for (auto* v : {&light_, &light_slope_}) Grow(*v, 3 * a_.stride);
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = c * a_.stride; i < c * a_.stride + live; ++i) {
      light_[i] = image::LinearFromSrgb(rgb_[i]);
      light_slope_[i] = image::LinearSlope(rgb_[i]);
    }
  }
  concealed_.clear();
  for (size_t k = 0; k < views_.size(); ++k) concealed_.push_back(ComposeConcealedRay(views_[k], rays_[k].patch));
}

ConcealedRay PacketTrainer::ComposeConcealedRay(const RayView& view, int64_t patch) {
  const auto begin = static_cast<size_t>(view.begin), count = static_cast<size_t>(view.count);
  ConcealedRay composed;
  composed.patch = patch;
  composed.plain = Compose(view);
  render::LightShares(ConcealingOf(shared_.luminance), static_cast<int>(count), convolution_.omega().data() + begin, share_.data() + begin);
  for (size_t i = 0; i < count; ++i) {
    const float seen = weight_[begin + i] * share_[begin + i];
    composed.shown_weight += seen;
    for (size_t c = 0; c < 3; ++c) composed.light[c] += seen * light_[c * a_.stride + begin + i];
  }
  const float transmittance = composed.plain.transmittance;
  composed.solid = transmittance < 1.0F - kSolidOpacity && composed.shown_weight > 0.0F;
  if (composed.solid) composed.log_share = std::log(composed.shown_weight / (1.0F - transmittance));
  return composed;
}

ConcealedTask PacketTrainer::TaskOfRays() const {
  ConcealedTask task;
  task.under = shared_.luminance.mode == brightness::LuminanceMode::kUnder;
  task.mean_share = static_cast<float>(std::exp(shared_.means.mean_log_gain));
  task.mean_log_gain = static_cast<float>(shared_.means.mean_log_gain);
  // Only the context controls the mean brightness; blocks keep the context's.
  task.pull = MeanBrightnessPull(shared_.controls_mean ? kLossWeights.mean_brightness : 0.0F, shared_.means.mean_shown, shared_.luminance.target);
  return task;
}

void PacketTrainer::ConcealAndLoss(float* network_gradient, LossSums& sums) {
  ComposeConcealed();
  const ConcealedTask task = TaskOfRays();
  for (size_t k = 0; k < views_.size(); ++k) {
    const BatchRay& r = Ray(k);
    const RayView& view = views_[k];
    const ConcealedRay& composed = concealed_[k];
    ConcealedGradient gradient;
    weight_gradient_.assign(static_cast<size_t>(view.count), 0.0F);
    if (r.ray.empty) {
      gradient.plain.transmittance = LossOfEmptyRay(composed.plain.transmittance, step_->ray_share, sums);
    } else {
      gradient = LossOfConcealedRay(r, view, composed, task, step_->ray_share, sums);
      KeepGainGradient(k, gradient.plain);
      gradient.log_share = LossOfShares(concealed_, k, task.mean_log_gain, sums) * step_->ray_share;
      if (composed.solid) {
        sums.log_share += static_cast<double>(composed.log_share);
        ++sums.solid_rays;
      }
      if (WantsDistortionLoss(r, view)) AddDistortion(view, sums);
    }
    ScatterConcealed(view, composed, gradient);
  }
  convolution_.Backward(a_.color_raw + 3 * a_.stride, shared_.weights.luminance, omega_gradient_.data(), a_.color_gradient + 3 * a_.stride,
                        network_gradient + shared_.field.LuminanceOffset());
  FinishGradients();
}

// weight_gradient_ already holds the gradient of the distortion loss, or zeros.
void PacketTrainer::ScatterConcealed(const RayView& view, const ConcealedRay& composed, const ConcealedGradient& gradient) {
  const auto begin = static_cast<size_t>(view.begin), count = static_cast<size_t>(view.count);
  const float* weights = weight_.data() + begin;
  const float per_shown = composed.shown_weight > 0.0F ? gradient.log_share / composed.shown_weight : 0.0F;
  for (size_t i = 0; i < count; ++i) {
    float all = 0.0F, omega_only = per_shown;
    for (size_t c = 0; c < 3; ++c) {
      const float light = light_[c * a_.stride + begin + i];
      all += gradient.light[c] * light;
      omega_only += gradient.share_light[c] * light;
    }
    weight_gradient_[i] += share_[begin + i] * all;
    share_gradient_[begin + i] = weights[i] * (all + omega_only);
  }
  render::LightSharesBackward(ConcealingOf(shared_.luminance), static_cast<int>(count), convolution_.omega().data() + begin, share_.data() + begin,
                              share_gradient_.data() + begin, omega_gradient_.data() + begin);
  ScatterComposed(view, composed.plain, gradient.plain, weight_gradient_.data());
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < count; ++i) {
      a_.color_gradient[c * a_.stride + begin + i] += gradient.light[c] * weights[i] * share_[begin + i] * light_slope_[c * a_.stride + begin + i];
    }
  }
}

}  // namespace skyquilt::worker
