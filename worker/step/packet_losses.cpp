// Computes the loss of every ray from its samples' densities and colours, and the gradients by these.
#include <algorithm>

#include "core/render/composite.h"
#include "worker/step/packet_trainer.h"

namespace skyquilt::worker {
namespace {

constexpr float kLeastColorSlope = 0.02F;
// tau of a sample beyond which it gets no denser: less than 1 % of the light passes, so more density changes nothing but its own parameters.
constexpr float kNoDenserTau = 5.0F;
// A sample this dense has left the range that a scene can need.
constexpr float kSaturatedTau = 1e4F;

}  // namespace

void PacketTrainer::ComposeAndLoss(LossSums& sums) {
  composed_.clear();
  for (const RayView& view : views_) composed_.push_back(Compose(view));
  FindStops();
  AddEndLosses(sums);
  for (size_t k = 0; k < views_.size(); ++k) {
    const BatchRay& r = Ray(k);
    const RayView& view = views_[k];
    const ComposedRay& composed = composed_[k];
    ComposedGradient gradient;
    const float* weight_gradient = nullptr;
    if (r.ray.empty) {
      gradient.transmittance = LossOfEmptyRay(composed.transmittance, step_->ray_share, sums);
    } else {
      gradient = LossOfRay(r, view, composed, step_->ray_share, sums);
      KeepGainGradient(k, gradient);
      const bool distorted = WantsDistortionLoss(r, view), at_point = WantsPointLoss(r, view);
      if (distorted || at_point || HasDistanceGradient(k)) {
        weight_gradient_.assign(static_cast<size_t>(view.count), 0.0F);
        if (distorted) AddDistortion(view, sums);
        if (at_point) AddPointLoss(r, view, sums);
        if (HasDistanceGradient(k)) AddDistanceGradient(k);
        weight_gradient = weight_gradient_.data();
      }
    }
    ScatterComposed(view, composed, gradient, weight_gradient);
  }
  std::fill_n(a_.color_gradient + 3 * a_.stride, static_cast<size_t>(live_), 0.0F);
  FinishGradients();
}

ComposedRay PacketTrainer::Compose(const RayView& view) {
  const auto begin = static_cast<size_t>(view.begin);
  ComposedRay composed;
  composed.transmittance = render::CompositeForward(static_cast<int>(view.count), tau_.data() + begin, rgb_.data() + begin, a_.stride,
                                                    weight_.data() + begin, composed.rgb);
  return composed;
}

void PacketTrainer::ScatterComposed(const RayView& view, const ComposedRay& composed, const ComposedGradient& gradient,
                                    const float* weight_gradient) {
  const auto begin = static_cast<size_t>(view.begin);
  render::CompositeBackward(static_cast<int>(view.count), rgb_.data() + begin, a_.stride, weight_.data() + begin, composed.transmittance,
                            gradient.rgb, gradient.transmittance, weight_gradient, a_.log_density_gradient + begin, a_.color_gradient + begin,
                            a_.stride);
}

void PacketTrainer::KeepGainGradient(size_t view, const ComposedGradient& gradient) const {
  if (step_->gain_gradients == nullptr) return;
  std::copy(gradient.log_gain, gradient.log_gain + 3, step_->gain_gradients[static_cast<size_t>(packet_->first_ray) + view].begin());
}

// A pixel of a reduced photo may show several distances.
bool PacketTrainer::WantsDistortionLoss(const BatchRay& ray, const RayView& view) const {
  return step_->distortion > 0.0 && view.count > 0 && ray.ray.level == 0;
}

void PacketTrainer::AddDistortion(const RayView& view, LossSums& sums) {
  const auto& map = shared_.target.map;
  const auto per_metre = static_cast<float>(1.0 / std::max(1.0, map.max_enu().z() - map.min_enu().z()));
  const float weight = static_cast<float>(step_->distortion) * step_->ray_share;
  const float loss =
      AddDistortionLoss(weight, static_cast<size_t>(view.count), weight_.data() + view.begin, step_->batch.t.data() + packet_->begin + view.begin,
                        static_cast<float>(shared_.target.step_m), per_metre, distortion_, weight_gradient_.data());
  sums.loss += static_cast<double>(loss) / static_cast<double>(step_->ray_share);
}

void PacketTrainer::FinishGradients() {
  const auto range = static_cast<float>(shared_.target.config.color_range);
  const auto live = static_cast<size_t>(live_);
  const auto padded = static_cast<size_t>(kernel::Padded(live_));
  // d tau / d log density = tau, but 0 where a step would make an opaque sample denser.
  for (size_t i = 0; i < live; ++i) {
    float& gradient = a_.log_density_gradient[i];
    gradient = tau_[i] > kNoDenserTau && gradient < 0.0F ? 0.0F : gradient * tau_[i];
    if (tau_[i] > kSaturatedTau) ++saturated_.densities;
  }
  std::fill(a_.log_density_gradient + live, a_.log_density_gradient + padded, 0.0F);
  // d rgb / d raw = rgb (1 - rgb / range). In a dark or bright survey colours that reach the end of their range in the first steps would get no
  // gradient and stay there, so a step towards the middle of the range has at least kLeastColorSlope. A step outwards has not: black pixels, glare
  // and sky ask for it in every step, and the networks' weights would grow without end.
  for (size_t c = 0; c < 3; ++c) {
    float* gradient = a_.color_gradient + c * a_.stride;
    const float* color = rgb_.data() + c * a_.stride;
    for (size_t i = 0; i < live; ++i) {
      const float slope = color[i] * (1.0F - color[i] / range);
      const bool inwards = (gradient[i] > 0.0F) == (color[i] > 0.5F * range);
      gradient[i] *= inwards ? std::max(slope, kLeastColorSlope) : slope;
      if (slope < kLeastColorSlope) ++saturated_.colors;
    }
  }
  for (size_t row = 0; row < field::kColorRows; ++row) {
    float* gradient = a_.color_gradient + row * a_.stride;
    std::fill(gradient + live, gradient + padded, 0.0F);
  }
}

}  // namespace skyquilt::worker
