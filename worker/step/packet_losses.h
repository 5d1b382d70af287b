// The losses of a packet's rays and their gradients by the samples' optical depths and colours, without a concealing field (with one:
// packet_concealed.h).
#pragma once

#include <vector>

#include "worker/losses/distortion_loss.h"
#include "worker/step/packet_ends.h"
#include "worker/step/packet_samples.h"

namespace skyquilt::worker {

// The distortion loss of one ray.
class PacketDistortion {
 public:
  explicit PacketDistortion(const PacketShared& shared) : target_(shared.target) {}

  // Not of rays of reduced photos, whose pixels may show several distances.
  static bool Wanted(const PacketSamples& s, size_t view) {
    return s.step->distortion > 0.0 && s.views[view].count > 0 && s.Ray(view).ray.level == 0;
  }
  // Adds the gradient by the weights of the ray's samples to weight_gradient.
  void Add(const PacketSamples& s, size_t of_view, float* weight_gradient, LossSums& sums);

 private:
  const render::TrainedField& target_;
  DistortionScratch<float> scratch_;
};

class PacketLosses {
 public:
  explicit PacketLosses(const PacketShared& shared) : distortion_(shared) {}

  // After PacketColor::Forward and PacketContext::Render. Writes s.weight and all rows of the samples' gradients. ends: null without priors.
  void Add(PacketSamples& s, PacketEnds* ends, LossSums& sums);

 private:
  PacketDistortion distortion_;
  std::vector<ComposedRay> composed_;   // per view
  std::vector<float> weight_gradient_;  // of one ray: by its samples' weights
};

}  // namespace skyquilt::worker
