// One optimiser step of one field on a drawn batch: encoding part by part (a hash grid's levels) over the whole batch, then every packet from density
// to gradient while its activations are in cache (packet_trainer.h), then the gradient's way back into the tables and Adam. Bits do not depend on the
// number of threads: parts have one writer each and network gradients are summed in fixed slots.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response_learner.h"
#include "core/field/optimizer.h"
#include "core/render/trained_field.h"
#include "worker/packet_trainer.h"
#include "worker/phase_times.h"
#include "worker/ray_batch.h"

namespace skyquilt::worker {

// What the photos' brightness asks of a field beside its colours.
struct LuminancePlan {
  brightness::Luminance luminance;
  brightness::LuminanceState start;  // what the context found, for blocks; where the context starts
  bool controls_mean = false;        // brings the mean brightness of what is shown to the target; else keeps to start.mean_log_gain
};

struct StepOptions {
  double learning_rate = 0.0;
  double network_l2 = 0.0;
  double distortion = 0.0;  // weight of the distortion loss (Barron et al. 2022, eq. 15), distances in units of the box height
};

struct StepResult {
  int n_rays = 0;
  int64_t n_samples = 0;       // evaluated for density
  int64_t n_live = 0;          // with colour and gradient
  double loss = 0.0;           // mean over rays
  double squared_error = 0.0;  // mean over colour rays and channels, display values
  bool finite = true;          // false: the step was dropped
};

class FieldStep {
 public:
  // target's map, step and colour range are read; parameters are handed to every step. context may be null; it is frozen.
  FieldStep(const render::TrainedField& target, const field::HashField& field, const render::TrainedField* context, const LuminancePlan& luminance,
            base::ThreadPool& threads, PhaseTimes& times);

  FieldStep(const FieldStep&) = delete;  // packet trainers refer to it
  FieldStep& operator=(const FieldStep&) = delete;

  // Learns from the batch; positions of its dropped samples are lost. Non-finite gradients leave parameters and state as they were. What the rays say
  // about their photos' brightness is added to the learner, when there is one; its step is the caller's.
  StepResult Train(RayBatch& batch, const StepOptions& options, field::Parameters& parameters, field::TrainableState& state,
                   brightness::ResponseLearner* learner);
  // Density and colour of every sample, for timing: the forward half alone.
  void Infer(RayBatch& batch, const field::Parameters& parameters);
  // Running means of a field with luminance; part of what a checkpoint holds.
  brightness::LuminanceState& luminance_state() { return state_; }
  // Optical depth of one marching step per sample of the last Train, 0 where no light arrived.
  const std::vector<float>& ObservedDepths() const { return observed_; }

 private:
  // Network gradients are summed in so many places, packet k in place k modulo that.
  static constexpr size_t kGradientSlots = 16;

  void Encode(const RayBatch& batch, std::span<const float> grid);
  // What the packets left behind, in their order.
  LossSums SumResults(const RayBatch& batch, StepResult* result);
  // Adds the slots' gradients to the state's; false when one is not finite.
  bool SumNetworkGradients(field::TrainableState& state) const;
  void FollowMeans(const LossSums& sums);

  const field::HashField& field_;
  brightness::Luminance luminance_;
  brightness::LuminanceState state_;
  bool controls_mean_;
  base::ThreadPool& threads_;
  PhaseTimes& times_;
  field::Optimizer optimizer_;
  field::NetworkWeights weights_;
  std::vector<std::unique_ptr<PacketTrainer>> trainers_;  // per thread
  std::vector<float> read_ahead_;                         // per thread
  std::vector<float> features_;                           // per packet, then the gradient in its place
  std::vector<float> observed_;
  std::vector<PacketResult> results_;
  std::vector<float> slot_gradients_;
  std::vector<std::array<float, 3>> gain_gradients_;  // per ray, by the logarithm of its gains; empty: nobody learns from them
  std::vector<field::GridGradient> gradient_segments_;
};

}  // namespace skyquilt::worker
