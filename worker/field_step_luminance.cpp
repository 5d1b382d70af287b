// The loss of fields with hidden light (core/brightness/luminance.h): two renderings from one density, of which the photos judge one and the
// wish for a given mean brightness the other.
#include <algorithm>
#include <cmath>

#include "core/brightness/tone_curve.h"
#include "core/image/srgb.h"
#include "core/render/composite.h"
#include "worker/field_step_worker.h"

namespace skyquilt::worker {
namespace {

using brightness::LuminanceMode;

// Weights beside the photos' loss. The brightness wish has a direction to itself, in which the photos do not care, so its size matters little.
constexpr float kControlWeight = 0.1F;
// Omega of neighbouring rays should agree, and all should stay near the survey's mean: otherwise Omega takes over the scene's texture.
constexpr float kSmoothWeight = 1e-2F, kMeanWeight = 1e-3F;
constexpr float kSolidOpacity = 0.2F;

// Linear light of a recorded ray as display value, with its derivatives by the light and by the logarithm of the gain.
brightness::Exposed RecordLight(float light, const brightness::Exposure& exposure) {
  const float recorded = exposure.gain * std::max(light, 0.0F);
  const float slope = image::SrgbSlope(recorded);
  return {image::SrgbFromLinear(recorded), slope * exposure.gain, slope * recorded};
}

}  // namespace

void FieldStep::PlanConcealed(const RayBatch& batch, const Packet& packet, int64_t n, Worker& w) const {
  const field::Activations& a = w.a;
  w.plans.assign(w.views.size(), {});
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
  const render::Concealing concealing = luminance_.product ? render::Concealing::kProduct : render::Concealing::kGain;
  for (size_t k = 0; k < w.views.size(); ++k) {
    const auto begin = static_cast<size_t>(w.views[k].begin), count = static_cast<size_t>(w.views[k].count);
    Worker::RayPlan& plan = w.plans[k];
    float* weights = w.weight.data() + begin;
    plan.transmittance = render::CompositeForward(static_cast<int>(count), w.tau.data() + begin, w.rgb.data() + begin, a.stride, weights, plan.rgb);
    render::LightShares(concealing, static_cast<int>(count), w.luminance.omega().data() + begin, w.share.data() + begin);
    for (size_t i = 0; i < count; ++i) {
      const float seen = weights[i] * w.share[begin + i];
      plan.shown_weight += seen;
      for (size_t c = 0; c < 3; ++c) plan.light[c] += seen * w.light[c * a.stride + begin + i];
    }
    plan.solid = plan.transmittance < 1.0F - kSolidOpacity && plan.shown_weight > 0.0F;
    if (plan.solid) plan.log_share = std::log(plan.shown_weight / (1.0F - plan.transmittance));
  }
}

// d loss / d log share of view k from the wish that neighbours agree and all stay near the mean.
float FieldStep::SmoothnessGradient(const Worker& w, size_t k, double* loss) const {
  const Worker::RayPlan& plan = w.plans[k];
  if (!plan.solid) return 0.0F;
  const float off = plan.log_share - static_cast<float>(state_.mean_log_gain);
  float gradient = 2.0F * kMeanWeight * off;
  *loss += static_cast<double>(kMeanWeight * off * off);
  for (const size_t other : {k - 1, k + 1}) {  // before the first: wraps to a number past the last
    if (other >= w.plans.size() || !w.plans[other].solid || w.rays[other].patch != w.rays[k].patch) continue;
    const float step = plan.log_share - w.plans[other].log_share;
    gradient += 2.0F * kSmoothWeight * step;
    *loss += static_cast<double>(0.5F * kSmoothWeight * step * step);
  }
  return gradient;
}

FieldStep::PacketResult FieldStep::ConcealAndLoss(const RayBatch& batch, const Packet& packet, int64_t n, float ray_share, double distortion,
                                                  float* network_gradient, Worker& w) {
  PacketResult result;
  field::Activations& a = w.a;
  PlanConcealed(batch, packet, n, w);
  const bool under = luminance_.mode == LuminanceMode::kUnder;
  const render::Concealing concealing = luminance_.product ? render::Concealing::kProduct : render::Concealing::kGain;
  const auto mean_share = static_cast<float>(std::exp(state_.mean_log_gain));
  // Only the context looks after the mean; blocks keep to what it found.
  const float pull = controls_mean_ ? 2.0F * kControlWeight * static_cast<float>(state_.mean_shown - luminance_.target) / 3.0F : 0.0F;
  for (size_t k = 0; k < w.views.size(); ++k) {
    const BatchRay& r = batch.rays[static_cast<size_t>(packet.first_ray) + k];
    const Worker::View& view = w.views[k];
    const Worker::RayPlan& plan = w.plans[k];
    const auto begin = static_cast<size_t>(view.begin), count = static_cast<size_t>(view.count);
    const float* weights = w.weight.data() + begin;
    float rgb_gradient[3] = {0, 0, 0};          // of the plain rendering's samples
    float light_gradient[3] = {0, 0, 0};        // of the concealed one's, all the way to density and colour
    float share_light_gradient[3] = {0, 0, 0};  // of the concealed one's, for Omega alone
    float transmittance_gradient = 0.0F;
    float log_share_gradient = 0.0F;
    w.weight_gradient.assign(count, 0.0F);
    if (r.ray.empty) {
      const float opacity = 1.0F - plan.transmittance;
      result.loss += static_cast<double>(opacity * opacity);
      transmittance_gradient = -2.0F * opacity * ray_share;
    } else {
      for (size_t c = 0; c < 3; ++c) {
        const float behind = view.behind_rgb[c] + view.background_share * r.background[c];
        const float plain = view.front_rgb[c] + view.front_transmittance * (plan.rgb[c] + plan.transmittance * behind);
        const float behind_light = view.behind_light[c] + view.background_share * mean_share * image::LinearFromSrgb(r.background[c]);
        const float light = view.front_light[c] + view.front_transmittance * (plan.light[c] + plan.transmittance * behind_light);
        const auto [value, slope, log_gain_slope] = under ? RecordLight(light, r.ray.exposure[c]) : brightness::Expose(plain, r.ray.exposure[c]);
        const float target = r.ray.target_srgb[c];
        result.squared_error += static_cast<double>(value - target) * static_cast<double>(value - target);
        const auto [toned, tone_slope] = brightness::ToneCurve(value);
        const float residual = toned - brightness::ToneCurve(target).value;
        float recorded_gradient = 0.0F;
        if (!SaysLittle(target, residual)) {
          result.loss += static_cast<double>(residual) * static_cast<double>(residual);
          const float toned_gradient = 2.0F * residual * tone_slope * ray_share;
          recorded_gradient = toned_gradient * slope * view.front_transmittance;
          if (!gain_gradients_.empty()) {
            gain_gradients_[static_cast<size_t>(packet.first_ray) + k][c] = toned_gradient * log_gain_slope;
          }
        }
        const float shown = under ? plain : image::SrgbFromLinear(std::max(light, 0.0F));
        result.shown += static_cast<double>(shown);
        if (under) {
          rgb_gradient[c] = pull * view.front_transmittance * ray_share;
          light_gradient[c] = recorded_gradient;
          transmittance_gradient += rgb_gradient[c] * behind + recorded_gradient * behind_light;
        } else {
          rgb_gradient[c] = recorded_gradient;
          share_light_gradient[c] = pull * image::SrgbSlope(std::max(light, 0.0F)) * view.front_transmittance * ray_share;
          transmittance_gradient += recorded_gradient * behind;
        }
      }
      ++result.color_rays;
      log_share_gradient = SmoothnessGradient(w, k, &result.loss) * ray_share;
      if (plan.solid) {
        result.log_share += static_cast<double>(plan.log_share);
        ++result.solid_rays;
      }
      if (distortion > 0.0 && count > 0) {
        result.loss += AddDistortion(batch, packet, view.begin, view.count, ray_share, distortion, w) / static_cast<double>(ray_share);
      }
    }
    const float per_shown = plan.shown_weight > 0.0F ? log_share_gradient / plan.shown_weight : 0.0F;
    for (size_t i = 0; i < count; ++i) {
      float all = 0.0F, omega_only = per_shown;
      for (size_t c = 0; c < 3; ++c) {
        const float light = w.light[c * a.stride + begin + i];
        all += light_gradient[c] * light;
        omega_only += share_light_gradient[c] * light;
      }
      w.weight_gradient[i] += w.share[begin + i] * all;
      w.share_gradient[begin + i] = weights[i] * (all + omega_only);
    }
    render::LightSharesBackward(concealing, static_cast<int>(count), w.luminance.omega().data() + begin, w.share.data() + begin,
                                w.share_gradient.data() + begin, w.omega_gradient.data() + begin);
    render::CompositeBackward(static_cast<int>(count), w.rgb.data() + begin, a.stride, weights, plan.transmittance, rgb_gradient,
                              transmittance_gradient, w.weight_gradient.data(), a.log_density_gradient + begin, a.color_gradient + begin, a.stride);
    for (size_t c = 0; c < 3; ++c) {
      for (size_t i = 0; i < count; ++i) {
        a.color_gradient[c * a.stride + begin + i] += light_gradient[c] * weights[i] * w.share[begin + i] * w.light_slope[c * a.stride + begin + i];
      }
    }
  }
  w.luminance.Backward(a.color_raw + 3 * a.stride, weights_.luminance, w.omega_gradient.data(), a.color_gradient + 3 * a.stride,
                       network_gradient + field_.LuminanceOffset());
  FinishGradients(n, w);
  return result;
}

}  // namespace skyquilt::worker
