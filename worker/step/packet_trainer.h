// The part of a training step that one thread computes: for one packet of rays after the other densities, colours, losses, and the gradient of the
// packet's features, in a workspace small enough to stay in cache. Each part is a class; they hand each other PacketSamples, in this order:
//   PacketDensity     features -> optical depths of the samples that light reaches
//   PacketColor       their colours
//   PacketContext     colours in front of and behind the block; only with a context
//   PacketLosses      losses of rays, with PacketEnds and PacketNormals in steps with such priors; or PacketConcealed with a concealing field
//   PacketDensity, PacketColor   gradients by the networks' outputs
// and last the networks' backward pass; after it, where poses are refined, PacketPoses: gradients by the rays. What is switched off does not exist.
#pragma once

#include <optional>

#include "core/field/optimizer.h"
#include "worker/phase_times.h"
#include "worker/step/packet_color.h"
#include "worker/step/packet_concealed.h"
#include "worker/step/packet_context.h"
#include "worker/step/packet_density.h"
#include "worker/step/packet_ends.h"
#include "worker/step/packet_losses.h"
#include "worker/step/packet_normals.h"
#include "worker/step/packet_poses.h"

namespace skyquilt::worker {

// Samples at the ends of their ranges.
struct SaturatedCounts {
  int64_t densities = 0;  // far denser than opaque
  int64_t colors = 0;     // channels within 2 % of an end of their range
};

struct PacketResult {
  LossSums sums;
  SaturatedCounts saturated;
  field::FeatureGradient gradient;  // of the samples that light reaches, which are moved to the packet's front
  bool finite = true;               // whether it and that of the surface points are finite
};

class PacketTrainer {
 public:
  // times: counted for `thread`. All references must outlive it.
  PacketTrainer(const PacketShared& shared, PhaseTimes& times, int thread);

  // Replaces the packet's features by their gradient and adds to network_gradient (HashField::NetworkParameters() numbers).
  PacketResult Train(const PacketStep& step, const Packet& packet, float* network_gradient);
  // Computes only density and colour, of all samples.
  void Infer(const PacketStep& step, const Packet& packet);

 private:
  // Makes the parts for the step's priors, which come and go during a training.
  void ChoosePriors(const StepPriors& priors);
  // Replaces the features by their gradient; false when it is not finite.
  bool Backward(float* network_gradient, const float* more_geometry_gradient);

  const PacketShared& shared_;
  PhaseTimes& times_;
  int thread_;
  PacketSamples samples_;
  PacketDensity density_;
  PacketColor color_;
  PacketPoses poses_;
  std::optional<PacketContext> context_;
  std::optional<PacketConcealed> concealed_;
  std::optional<PacketLosses> losses_;    // without concealed_
  std::optional<PacketEnds> ends_;        // with losses_ only
  std::optional<PacketNormals> normals_;  // with ends_ only
};

}  // namespace skyquilt::worker
