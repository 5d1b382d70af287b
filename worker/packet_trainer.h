// One thread's share of a training step: takes one packet after the other from density to the gradient of its features, in a workspace of its own
// that stays in cache.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/brightness/luminance.h"
#include "core/field/hash_field.h"
#include "core/render/ray_engine.h"
#include "core/render/trained_field.h"
#include "worker/concealed_ray_loss.h"
#include "worker/losses/distortion_loss.h"
#include "worker/luminance_convolution.h"
#include "worker/phase_times.h"
#include "worker/ray_batch.h"
#include "worker/ray_loss.h"

namespace skyquilt::worker {

// Densities are exp of at most this, so that they and their gradients stay finite.
constexpr float kMaxLogDepth = 15.0F;

// What every packet of every step reads.
struct PacketShared {
  const render::TrainedField& target;  // map, step and colour range; not its parameters
  const field::HashField& field;
  const render::TrainedField* context;  // frozen; may be null
  const field::NetworkWeights& weights;
  const brightness::Luminance& luminance;
  const brightness::LuminanceState& means;
  bool controls_mean;  // of luminance: LuminancePlan::controls_mean
};

// What the packets of one step share. Each packet writes to its own places alone.
struct PacketStep {
  RayBatch& batch;  // x, y, z and t of hidden samples are lost
  float* features;  // at Packet::features; their gradient takes their place
  float* observed;  // per sample: optical depth of a marching step, 0 where no light arrives; not used by Infer
  float ray_share;  // 1 / rays of the batch
  double distortion;
  std::array<float, 3>* gain_gradients;  // per ray, by the logarithm of its gains; null: nobody learns from them
};

struct PacketResult {
  LossSums sums;
  int64_t live = 0;    // samples that light reaches; they come first
  bool finite = true;  // the features' gradient
};

class PacketTrainer {
 public:
  // times: charged to `thread`. All references must outlive it.
  PacketTrainer(const PacketShared& shared, PhaseTimes& times, int thread);

  // Leaves the features' gradient and adds to network_gradient (HashField::NetworkParameters()).
  PacketResult Train(const PacketStep& step, const Packet& packet, float* network_gradient);
  // Density and colour of all samples.
  void Infer(const PacketStep& step, const Packet& packet);

 private:
  // packet_trainer.cpp: from features to densities and colours.
  void Begin(const PacketStep& step, const Packet& packet);
  const BatchRay& Ray(size_t view) const { return step_->batch.rays[static_cast<size_t>(packet_->first_ray) + view]; }
  float* Features() const { return step_->features + packet_->features; }
  void Density();
  void DropHidden();
  int64_t LiveSamples(size_t view, int64_t first_live);
  void ZeroPadding(float* rows, int n_rows, size_t stride) const;
  void KeepAll();
  void Color();
  bool Backward(float* network_gradient);

  // packet_trainer_context.cpp: what the frozen context shows in front of the box's ground plan and, where light passes through, behind it.
  void LookThroughContext();
  void AddPieces(size_t view);
  void TakeColors();

  // packet_trainer_compose.cpp: losses, and back to the networks' outputs.
  void ComposeAndLoss(LossSums& sums);
  ComposedRay Compose(const RayView& view);
  // From what a ray came to back to its samples' optical depths and colours. weight_gradient: by the compositing weights, or null.
  void ScatterComposed(const RayView& view, const ComposedRay& composed, const ComposedGradient& gradient, const float* weight_gradient);
  void KeepGainGradient(size_t view, const ComposedGradient& gradient) const;
  // Distortion loss of one ray; its gradient is added to weight_gradient_.
  void AddDistortion(const RayView& view, LossSums& sums);
  // From gradients of optical depths and colours to those of the networks' outputs.
  void FinishGradients();

  // packet_trainer_luminance.cpp: the same for fields with concealing field.
  void ConcealAndLoss(float* network_gradient, LossSums& sums);
  ConcealedTask TaskOfRays() const;
  void ComposeConcealed();
  ConcealedRay ComposeConcealedRay(const RayView& view, int64_t patch);
  void ScatterConcealed(const RayView& view, const ConcealedRay& composed, const ConcealedGradient& gradient);

  PacketShared shared_;
  PhaseTimes& times_;
  int thread_;
  // The packet at hand.
  const PacketStep* step_ = nullptr;
  const Packet* packet_ = nullptr;
  int64_t live_ = 0;  // its samples that light reaches; all of them until DropHidden
  // Per sample, rows of a_.stride.
  field::Activations a_;
  std::vector<float> depth_, keep_, tau_, weight_, rgb_, weight_gradient_;
  DistortionScratch<float> distortion_;
  std::vector<RayView> views_;  // rays of the packet
  // The context's intervals of rays.
  std::unique_ptr<render::RayRenderer> context_;
  std::vector<render::Ray> pieces_;
  std::vector<render::RayColor> colors_;
  std::vector<std::pair<size_t, bool>> owner_;  // view, is it the piece behind
  // With luminance only.
  LuminanceConvolution convolution_;
  std::vector<float> share_, share_gradient_, omega_gradient_;  // per sample
  std::vector<float> light_, light_slope_;                      // linear light of the samples and its slope by display value, rows as rgb
  std::vector<ConvolvedRay> rays_;                              // per view
  std::vector<ConcealedRay> concealed_;                         // per view
};

// Makes room for n values; never shrinks.
template <typename T>
void Grow(std::vector<T>& v, size_t n) {
  if (v.size() < n) v.resize(n + n / 4);
}

}  // namespace skyquilt::worker
