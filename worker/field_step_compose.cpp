// From the samples' densities and colours to the loss of every ray and back.
#include <algorithm>
#include <cmath>

#include "core/render/composite.h"
#include "worker/field_step_worker.h"

namespace skyquilt::worker {

namespace {

constexpr float kLeastColorSlope = 0.02F;

}  // namespace

bool SaysLittle(float target_srgb, float residual) {
  return (target_srgb >= 254.5F / 255.0F && residual > 0.0F) || (target_srgb <= 0.5F / 255.0F && residual < 0.0F);
}

FieldStep::PacketResult FieldStep::ComposeAndLoss(const RayBatch& batch, const Packet& packet, int64_t n, float ray_share, double distortion,
                                                  Worker& w) {
  PacketResult result;
  field::Activations& a = w.a;
  for (size_t k = 0; k < w.views.size(); ++k) {
    const BatchRay& r = batch.rays[static_cast<size_t>(packet.first_ray) + k];
    const Worker::View& view = w.views[k];
    const auto begin = static_cast<size_t>(view.begin);
    const auto count = static_cast<size_t>(view.count);
    float rgb[3];
    float* weights = w.weight.data() + begin;
    const float transmittance = render::CompositeForward(static_cast<int>(count), w.tau.data() + begin, w.rgb.data() + begin, a.stride, weights, rgb);
    float rgb_gradient[3] = {0, 0, 0};
    float transmittance_gradient = 0.0F;
    const float* weight_gradient = nullptr;
    if (r.ray.empty) {
      const float opacity = 1.0F - transmittance;
      result.loss += static_cast<double>(opacity * opacity);
      transmittance_gradient = -2.0F * opacity * ray_share;
    } else {
      for (size_t c = 0; c < 3; ++c) {
        const float behind = view.behind_rgb[c] + view.background_share * r.background[c];
        const float shown = view.front_rgb[c] + view.front_transmittance * (rgb[c] + transmittance * behind);
        const auto [value, slope, log_gain_slope] = brightness::Expose(shown, r.ray.exposure[c]);
        const float target = r.ray.target_srgb[c];
        const float residual = value - target;
        const double squared = static_cast<double>(residual) * static_cast<double>(residual);
        result.squared_error += squared;
        if (SaysLittle(target, residual)) continue;
        result.loss += squared;
        if (!gain_gradients_.empty()) {
          gain_gradients_[static_cast<size_t>(packet.first_ray) + k][c] = 2.0F * residual * log_gain_slope * ray_share;
        }
        const float gradient = 2.0F * residual * slope * view.front_transmittance * ray_share;
        rgb_gradient[c] = gradient;
        transmittance_gradient += gradient * behind;
      }
      ++result.color_rays;
      if (distortion > 0.0 && count > 0) {
        w.weight_gradient.assign(count, 0.0F);
        result.loss += AddDistortion(batch, packet, view.begin, view.count, ray_share, distortion, w) / static_cast<double>(ray_share);
        weight_gradient = w.weight_gradient.data();
      }
    }
    render::CompositeBackward(static_cast<int>(count), w.rgb.data() + begin, a.stride, weights, transmittance, rgb_gradient, transmittance_gradient,
                              weight_gradient, a.log_density_gradient + begin, a.color_gradient + begin, a.stride);
  }
  std::fill_n(a.color_gradient + 3 * a.stride, static_cast<size_t>(n), 0.0F);
  FinishGradients(n, w);
  return result;
}

double FieldStep::AddDistortion(const RayBatch& batch, const Packet& packet, int64_t begin, int64_t count, float ray_share, double distortion,
                                Worker& w) const {
  const auto unit = static_cast<float>(1.0 / std::max(1.0, target_.map.max_enu().z() - target_.map.min_enu().z()));
  const auto n = static_cast<size_t>(count);
  w.mid.resize(n);
  w.width.assign(n, static_cast<float>(target_.step_m) * unit);
  const float* t = batch.t.data() + packet.begin + begin;
  for (size_t i = 0; i < n; ++i) w.mid[i] = (t[i] - t[0]) * unit;
  return static_cast<double>(render::DistortionLoss(static_cast<int>(n), w.weight.data() + begin, w.mid.data(), w.width.data(),
                                                    static_cast<float>(distortion) * ray_share, w.weight_gradient.data()));
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
