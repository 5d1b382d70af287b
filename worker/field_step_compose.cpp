// From the samples' densities and colours to the loss of every ray and back.
#include <algorithm>
#include <cmath>

#include "core/render/composite.h"
#include "worker/field_step_worker.h"

namespace skyquilt::worker {
namespace {

constexpr float kLeastColorSlope = 0.02F;

}  // namespace

FieldStep::PacketResult FieldStep::ComposeAndLoss(const RayBatch& batch, const Packet& packet, int64_t n, float ray_share, double distortion,
                                                  Worker& w) {
  PacketResult result;
  for (size_t k = 0; k < w.views.size(); ++k) {
    const size_t ray = static_cast<size_t>(packet.first_ray) + k;
    const BatchRay& r = batch.rays[ray];
    const RayView& view = w.views[k];
    const ComposedRay composed = Compose(view, w);
    ComposedGradient gradient;
    const float* weight_gradient = nullptr;
    if (r.ray.empty) {
      gradient.transmittance = LossOfEmptyRay(composed.transmittance, ray_share, result.sums);
    } else {
      gradient = LossOfRay(r, view, composed, ray_share, result.sums);
      KeepGainGradient(ray, gradient);
      if (distortion > 0.0 && view.count > 0) {
        w.weight_gradient.assign(static_cast<size_t>(view.count), 0.0F);
        AddDistortion(batch, packet, view, ray_share, distortion, w, result.sums);
        weight_gradient = w.weight_gradient.data();
      }
    }
    ScatterComposed(view, composed, gradient, weight_gradient, w);
  }
  std::fill_n(w.a.color_gradient + 3 * w.a.stride, static_cast<size_t>(n), 0.0F);
  FinishGradients(n, w);
  return result;
}

ComposedRay FieldStep::Compose(const RayView& view, Worker& w) {
  const auto begin = static_cast<size_t>(view.begin);
  ComposedRay composed;
  composed.transmittance = render::CompositeForward(static_cast<int>(view.count), w.tau.data() + begin, w.rgb.data() + begin, w.a.stride,
                                                    w.weight.data() + begin, composed.rgb);
  return composed;
}

void FieldStep::ScatterComposed(const RayView& view, const ComposedRay& composed, const ComposedGradient& gradient, const float* weight_gradient,
                                Worker& w) {
  const auto begin = static_cast<size_t>(view.begin);
  field::Activations& a = w.a;
  render::CompositeBackward(static_cast<int>(view.count), w.rgb.data() + begin, a.stride, w.weight.data() + begin, composed.transmittance,
                            gradient.rgb, gradient.transmittance, weight_gradient, a.log_density_gradient + begin, a.color_gradient + begin,
                            a.stride);
}

void FieldStep::KeepGainGradient(size_t ray, const ComposedGradient& gradient) {
  if (gain_gradients_.empty()) return;
  std::copy(gradient.log_gain, gradient.log_gain + 3, gain_gradients_[ray].begin());
}

void FieldStep::AddDistortion(const RayBatch& batch, const Packet& packet, const RayView& view, float ray_share, double distortion, Worker& w,
                              LossSums& sums) const {
  const auto per_metre = static_cast<float>(1.0 / std::max(1.0, target_.map.max_enu().z() - target_.map.min_enu().z()));
  const float loss = AddDistortionLoss(static_cast<float>(distortion) * ray_share, static_cast<size_t>(view.count), w.weight.data() + view.begin,
                                       batch.t.data() + packet.begin + view.begin, static_cast<float>(target_.step_m), per_metre, w.distortion,
                                       w.weight_gradient.data());
  sums.loss += static_cast<double>(loss) / static_cast<double>(ray_share);
}

void FieldStep::FinishGradients(int64_t n, Worker& w) const {
  field::Activations& a = w.a;
  const auto range = static_cast<float>(target_.config.color_range);
  const auto live = static_cast<size_t>(n);
  const auto padded = static_cast<size_t>(kernel::Padded(n));
  // d tau / d log density = tau; d rgb / d raw = rgb (1 - rgb / range), and never nothing: colours of a dark or bright survey that overshoot the end
  // of the scale in the first steps would never come back.
  for (size_t i = 0; i < live; ++i) a.log_density_gradient[i] *= w.tau[i];
  std::fill(a.log_density_gradient + live, a.log_density_gradient + padded, 0.0F);
  for (size_t c = 0; c < 3; ++c) {
    float* gradient = a.color_gradient + c * a.stride;
    const float* color = w.rgb.data() + c * a.stride;
    for (size_t i = 0; i < live; ++i) gradient[i] *= std::max(color[i] * (1.0F - color[i] / range), kLeastColorSlope);
  }
  for (size_t row = 0; row < field::kColorRows; ++row) {
    float* gradient = a.color_gradient + row * a.stride;
    std::fill(gradient + live, gradient + padded, 0.0F);
  }
}

}  // namespace skyquilt::worker
