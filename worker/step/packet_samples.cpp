#include "worker/step/packet_samples.h"

#include <algorithm>

#include "core/render/composite.h"

namespace skyquilt::worker {

void PacketSamples::Begin(const PacketStep& of_step, const Packet& of_packet, const field::HashField& field) {
  step = &of_step;
  packet = &of_packet;
  live = packet->count;
  views.assign(static_cast<size_t>(packet->n_rays), {});
  a.Reserve(field, Padded());
  Grow(tau, a.stride);
  Grow(weight, a.stride);
  Grow(rgb, 3 * a.stride);
}

void PacketSamples::ZeroPadding(float* rows, int n_rows, size_t stride) const {
  const int64_t end = Padded();
  for (int row = 0; row < n_rows; ++row) {
    float* values = rows + static_cast<size_t>(row) * stride;
    std::fill(values + live, values + end, 0.0F);
  }
}

ComposedRay PacketSamples::Compose(const RayView& view) {
  const auto begin = static_cast<size_t>(view.begin);
  ComposedRay composed;
  composed.transmittance =
      render::CompositeForward(static_cast<int>(view.count), tau.data() + begin, rgb.data() + begin, a.stride, weight.data() + begin, composed.rgb);
  return composed;
}

void PacketSamples::Scatter(const RayView& view, const ComposedRay& composed, const ComposedGradient& gradient, const float* weight_gradient) {
  const auto begin = static_cast<size_t>(view.begin);
  render::CompositeBackward(static_cast<int>(view.count), rgb.data() + begin, a.stride, weight.data() + begin, composed.transmittance, gradient.rgb,
                            gradient.transmittance, weight_gradient, a.log_density_gradient + begin, a.color_gradient + begin, a.stride);
}

void PacketSamples::KeepGainGradient(size_t view, const ComposedGradient& gradient) const {
  if (step->gain_gradients == nullptr) return;
  std::copy(gradient.log_gain, gradient.log_gain + 3, step->gain_gradients[static_cast<size_t>(packet->first_ray) + view].begin());
}

}  // namespace skyquilt::worker
