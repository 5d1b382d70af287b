#include "worker/step/packet_losses.h"

#include <algorithm>

namespace skyquilt::worker {

void PacketDistortion::Add(const PacketSamples& s, size_t of_view, float* weight_gradient, LossSums& sums) {
  const RayView& view = s.views[of_view];
  const RayBatch& batch = s.step->batch;
  // The live samples of a ray are its first ones.
  const float* const steps = batch.uneven ? batch.unit_length.data() + s.Ray(of_view).begin : nullptr;
  const auto per_metre = static_cast<float>(1.0 / std::max(1.0, target_.map.max_enu().z() - target_.map.min_enu().z()));
  const float weight = static_cast<float>(s.step->distortion) * s.step->ray_share;
  const float loss = AddDistortionLoss(weight, static_cast<size_t>(view.count), s.weight.data() + view.begin, s.Distances() + view.begin,
                                       static_cast<float>(target_.step_m), steps, per_metre, scratch_, weight_gradient);
  sums.loss += static_cast<double>(loss) / static_cast<double>(s.step->ray_share);
}

void PacketLosses::Add(PacketSamples& s, PacketEnds* ends, LossSums& sums) {
  composed_.clear();
  for (const RayView& view : s.views) composed_.push_back(s.Compose(view));
  if (ends != nullptr) ends->Find(s, sums);
  for (size_t k = 0; k < s.views.size(); ++k) {
    const BatchRay& r = s.Ray(k);
    const RayView& view = s.views[k];
    ComposedGradient gradient;
    const float* weight_gradient = nullptr;
    if (r.ray.empty) {
      gradient.transmittance = LossOfEmptyRay(composed_[k].transmittance, s.step->ray_share, sums);
    } else {
      gradient = LossOfRay(r, view, composed_[k], s.step->ray_share, sums);
      s.KeepGainGradient(k, gradient);
      const bool distorted = PacketDistortion::Wanted(s, k), at_end = ends != nullptr && ends->HasGradient(s, k);
      if (distorted || at_end) {
        weight_gradient_.assign(static_cast<size_t>(view.count), 0.0F);
        if (distorted) distortion_.Add(s, k, weight_gradient_.data(), sums);
        if (at_end) ends->AddGradient(s, k, weight_gradient_.data(), sums);
        weight_gradient = weight_gradient_.data();
      }
    }
    s.Scatter(view, composed_[k], gradient, weight_gradient);
  }
  std::fill_n(s.a.color_gradient + 3 * s.a.stride, static_cast<size_t>(s.live), 0.0F);
}

}  // namespace skyquilt::worker
