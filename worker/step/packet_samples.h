// What the parts of a packet's training hand each other: the step, the packet and its samples with their densities, colours and gradients.
// Arrays per sample begin with the packet's first live sample; those of several rows have a.stride floats per row. One object per thread, whose
// buffers stay from packet to packet.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/brightness/luminance.h"
#include "core/field/hash_field.h"
#include "core/render/trained_field.h"
#include "worker/rays/ray_batch.h"
#include "worker/step/appearance_codes.h"
#include "worker/step/ray_gradients.h"
#include "worker/step/ray_loss.h"
#include "worker/step/step_priors.h"

namespace skyquilt::worker {

// Read by every packet of every step.
struct PacketShared {
  const render::TrainedField& target;  // map, step and colour range; not its parameters
  const field::HashField& field;
  const render::TrainedField* context;  // not trained; may be null
  const brightness::Luminance& luminance;
  const brightness::LuminanceState& means;
  bool controls_mean;  // LuminancePlan::controls_mean
};

// Used by all packets of one step. Each packet writes only to its own ranges of the arrays.
struct PacketStep {
  RayBatch& batch;  // x, y, z, sharpness and t of hidden samples are overwritten
  field::NetworkWeights weights;
  std::span<const float> grid;  // parameters of the encoding
  float* features;              // at Packet::features; overwritten by their gradient
  float* observed = nullptr;    // per sample: tau of a marching step, 0 where no light arrives; not used by Infer
  float ray_share = 0.0F;       // 1 / rays of the batch
  double distortion = 0.0;      // weight of the distortion loss
  StepPriors priors = {};
  std::array<float, 3>* gain_gradients = nullptr;  // per ray, by its log gains; null without a learner
  const AppearanceCodes* codes = nullptr;          // of the rays' photos; null: every ray has the code of the mean look
  float* code_gradients = nullptr;                 // per ray with codes, as many numbers as a code has; written by the packets with live samples
  RayGradients* ray_gradients = nullptr;           // with rays of the batch's number, which are written; null: not wanted
  struct SurfacePoints* surface_points = nullptr;  // per packet, written; null without losses of normals
};

struct PacketSamples {
  // All samples of the packet are live; the arrays have room for them.
  void Begin(const PacketStep& of_step, const Packet& of_packet, const field::HashField& field);

  const BatchRay& Ray(size_t view) const { return step->batch.rays[static_cast<size_t>(packet->first_ray) + view]; }
  float* Features() const { return step->features + packet->features; }            // rows of packet->stride
  const float* Distances() const { return step->batch.t.data() + packet->begin; }  // metres from the camera
  int64_t Padded() const { return kernel::Padded(live); }
  // The networks' sums include the padding behind the live samples, so it must be finite.
  void ZeroPadding(float* rows, int n_rows, size_t stride) const;

  // Composites a ray from tau and rgb; writes weight.
  ComposedRay Compose(const RayView& view);
  // Writes the gradients by a ray's tau (to a.log_density_gradient) and rgb (to a.color_gradient). weight_gradient: of the ray's samples, further
  // gradients by their weights; or null.
  void Scatter(const RayView& view, const ComposedRay& composed, const ComposedGradient& gradient, const float* weight_gradient);
  void KeepGainGradient(size_t view, const ComposedGradient& gradient) const;

  const PacketStep* step = nullptr;
  const Packet* packet = nullptr;
  int64_t live = 0;            // samples that light reaches; all until PacketDensity::DropHidden
  std::vector<RayView> views;  // rays of the packet
  field::Activations a;
  std::vector<float> tau, weight;  // optical depth of the sample's interval; compositing weight
  std::vector<float> rgb;          // 3 rows, display values
};

// Makes room for n values; never shrinks.
template <typename T>
void Grow(std::vector<T>& v, size_t n) {
  if (v.size() < n) v.resize(n + n / 4);
}

}  // namespace skyquilt::worker
