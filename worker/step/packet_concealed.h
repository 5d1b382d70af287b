// As packet_losses.h, with a concealing field (core/brightness/luminance.h), whose losses know no distances of rays.
#pragma once

#include <vector>

#include "worker/step/concealed_ray_loss.h"
#include "worker/step/luminance_convolution.h"
#include "worker/step/packet_losses.h"

namespace skyquilt::worker {

class PacketConcealed {
 public:
  explicit PacketConcealed(const PacketShared& shared) : shared_(shared), distortion_(shared) {}

  // After PacketColor::Forward and PacketContext::Render. Writes s.weight and all rows of the samples' gradients; adds to the gradient of the
  // convolution's taps in network_gradient.
  void Add(PacketSamples& s, float* network_gradient, LossSums& sums);

 private:
  // Computes Omega and linear light of the samples, and both renderings of every ray.
  void Compose(PacketSamples& s);
  ConcealedRay ComposeRay(PacketSamples& s, size_t view);
  ConcealedTask TaskOfRays() const;
  void Scatter(PacketSamples& s, const RayView& view, const ConcealedRay& composed, const ConcealedGradient& gradient);

  const PacketShared& shared_;
  PacketDistortion distortion_;
  LuminanceConvolution convolution_;
  std::vector<ConvolvedRay> rays_;                              // per view
  std::vector<ConcealedRay> concealed_;                         // per view
  std::vector<float> share_, share_gradient_, omega_gradient_;  // per sample
  std::vector<float> light_, light_slope_;  // linear light of the samples and its derivative by display value; rows as PacketSamples::rgb
  std::vector<float> weight_gradient_;      // of one ray: by its samples' weights
};

}  // namespace skyquilt::worker
