// The part of a training step that one thread computes: for one packet of rays after the other densities, colours, loss, and the gradient of the
// packet's features, in a workspace small enough to stay in cache.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/brightness/luminance.h"
#include "core/field/hash_field.h"
#include "core/render/ray_engine.h"
#include "core/render/trained_field.h"
#include "worker/losses/distortion_loss.h"
#include "worker/phase_times.h"
#include "worker/rays/ray_batch.h"
#include "worker/step/concealed_ray_loss.h"
#include "worker/step/luminance_convolution.h"
#include "worker/step/ray_loss.h"
#include "worker/step/step_priors.h"
#include "worker/step/surface_points.h"

namespace skyquilt::worker {

// Upper limit of the logarithm of tau of a step, so that densities and their gradients stay finite.
constexpr float kMaxLogTau = 15.0F;

// Read by every packet of every step.
struct PacketShared {
  const render::TrainedField& target;  // map, step and colour range; not its parameters
  const field::HashField& field;
  const render::TrainedField* context;  // not trained; may be null
  const field::NetworkWeights& weights;
  const brightness::Luminance& luminance;
  const brightness::LuminanceState& means;
  bool controls_mean;  // LuminancePlan::controls_mean
};

// Used by all packets of one step. Each packet writes only to its own ranges of the arrays.
struct PacketStep {
  RayBatch& batch;    // x, y, z and t of hidden samples are overwritten
  float* features;    // at Packet::features; overwritten by their gradient
  float* observed;    // per sample: tau of a marching step, 0 where no light arrives; not used by Infer
  float ray_share;    // 1 / rays of the batch
  double distortion;  // weight of the distortion loss
  StepPriors priors;
  std::array<float, 3>* gain_gradients;  // per ray, by its log gains; null without a learner
  std::span<const float> grid;           // parameters of the encoding
  SurfacePoints* surface_points;         // per packet, written; null without losses of normals
};

// Samples at the ends of their ranges.
struct SaturatedCounts {
  int64_t densities = 0;  // far denser than opaque
  int64_t colors = 0;     // channels within 2 % of an end of their range
};

struct PacketResult {
  LossSums sums;
  SaturatedCounts saturated;
  int64_t live = 0;    // samples that light reaches; they are moved to the front
  bool finite = true;  // whether the features' gradient is finite
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
  bool Backward(float* network_gradient, const float* more_geometry_gradient);

  // packet_trainer_context.cpp: renders the context in front of the block's ground plan and, where light passes through the block, behind it.
  void RenderContext();
  void AddContextRays(size_t view);
  void StoreContextColors();

  // packet_trainer_compose.cpp: losses, and their gradients by the networks' outputs.
  void ComposeAndLoss(LossSums& sums);
  ComposedRay Compose(const RayView& view);
  // Gradients by the optical depths and colours of a ray's samples. weight_gradient: further gradients by the compositing weights, or null.
  void ScatterComposed(const RayView& view, const ComposedRay& composed, const ComposedGradient& gradient, const float* weight_gradient);
  void KeepGainGradient(size_t view, const ComposedGradient& gradient) const;
  // Distortion loss of one ray; its gradient is added to weight_gradient_.
  bool WantsDistortionLoss(const BatchRay& ray, const RayView& view) const;
  void AddDistortion(const RayView& view, LossSums& sums);
  // packet_trainer_priors.cpp: losses of the distances at which rays end.
  void FindStops();
  void AddEndLosses(LossSums& sums);
  void AddDistanceLoss(size_t view, double weight, const Eigen::Vector3d& on_plane, const Eigen::Vector3d& normal, LossSums& sums);
  void AddKnownPlaneLoss(size_t view, LossSums& sums);
  void AddSegmentLoss(size_t first, size_t end, LossSums& sums);
  bool HasDistanceGradient(size_t view) const { return !distance_gradient_.empty() && distance_gradient_[view] != 0.0F; }
  void AddDistanceGradient(size_t view);
  bool WantsPointLoss(const BatchRay& ray, const RayView& view) const;
  void AddPointLoss(const BatchRay& ray, const RayView& view, LossSums& sums);

  // packet_trainer_normals.cpp: losses of normals at the ends of rays. Returns whether geometry_gradient_ has a gradient by the samples' geometry.
  bool AddNormalLosses(SurfacePoints& points, float* network_gradient, LossSums& sums);
  void PlaceSurfacePoints(SurfacePoints& points) const;
  void AddNormalLoss(size_t view, size_t point, bool head, LossSums& sums);

  // Turns gradients by optical depths and colours into gradients by the networks' outputs.
  void FinishGradients();

  // packet_trainer_luminance.cpp: the same with a concealing field.
  void ConcealAndLoss(float* network_gradient, LossSums& sums);
  ConcealedTask TaskOfRays() const;
  void ComposeConcealed();
  ConcealedRay ComposeConcealedRay(const RayView& view, int64_t patch);
  void ScatterConcealed(const RayView& view, const ConcealedRay& composed, const ConcealedGradient& gradient);

  PacketShared shared_;
  PhaseTimes& times_;
  int thread_;
  // The current packet.
  const PacketStep* step_ = nullptr;
  const Packet* packet_ = nullptr;
  int64_t live_ = 0;  // its samples that light reaches; all of them until DropHidden
  SaturatedCounts saturated_;
  // Per sample, rows of a_.stride.
  field::Activations a_;
  std::vector<float> depth_, keep_, tau_, weight_, rgb_, weight_gradient_;
  DistortionScratch<float> distortion_;
  std::vector<RayView> views_;  // rays of the packet
  std::vector<ComposedRay> composed_;
  std::vector<float> stops_;              // per sample: metres from the camera at which its light is stopped on average; only with priors
  std::vector<RayEnd> ends_;              // per view; empty unless a prior needs them
  std::vector<float> distance_gradient_;  // of the batch's mean loss by the mean distance of each view; empty without priors
  // With losses of normals only.
  std::vector<size_t> normal_views_;  // whose ends have such a loss
  field::DensitySlope slope_;
  std::vector<float> slope_along_;                     // 3 rows of slope_.stride: by the gradient of the log density
  std::vector<float> predicted_, predicted_gradient_;  // rows of the normal head
  std::vector<float> geometry_gradient_;
  // Intervals of rays that are rendered from the context.
  std::unique_ptr<render::RayRenderer> context_;
  std::vector<render::Ray> pieces_;
  std::vector<render::RayColor> colors_;
  std::vector<std::pair<size_t, bool>> owner_;  // view, and whether its interval is behind the block
  // With luminance only.
  LuminanceConvolution convolution_;
  std::vector<float> share_, share_gradient_, omega_gradient_;  // per sample
  std::vector<float> light_, light_slope_;                      // linear light of the samples and its derivative by display value; rows as rgb_
  std::vector<ConvolvedRay> rays_;                              // per view
  std::vector<ConcealedRay> concealed_;                         // per view
};

// Makes room for n values; never shrinks.
template <typename T>
void Grow(std::vector<T>& v, size_t n) {
  if (v.size() < n) v.resize(n + n / 4);
}

}  // namespace skyquilt::worker
