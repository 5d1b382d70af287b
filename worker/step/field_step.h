// One optimiser step of one field on a batch of rays, ordered for the cache:
//   1. encode all samples, one part of the encoding (a level of the hash grid) after the other
//   2. per packet of rays: densities, colours, loss and their gradients, while activations are in cache (packet_trainer.h)
//   3. scatter the gradients into the tables, Adam
// Same bits for any number of threads: every part has one writer, and network gradients are summed in fixed slots.
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
#include "worker/phase_times.h"
#include "worker/rays/ray_batch.h"
#include "worker/step/appearance_codes.h"
#include "worker/step/packet_trainer.h"

namespace skyquilt::worker {

// How a field is trained when the survey has a concealing field (core/brightness/luminance.h).
struct LuminancePlan {
  brightness::Luminance luminance;
  brightness::LuminanceState start;  // of the context: initial values; of blocks: the trained context's values
  bool controls_mean = false;  // true: brings the mean brightness shown to people to the target; false: keeps log Omega near start.mean_log_gain
};

struct StepOptions {
  double learning_rate = 0.0;
  double network_l2 = 0.0;
  double distortion = 0.0;  // weight of the distortion loss (Barron et al. 2022, eq. 15), distances in units of the box height
  StepPriors priors = {};
};

struct StepResult {
  int n_rays = 0;
  int64_t n_samples = 0;       // evaluated for density
  int64_t n_live = 0;          // of these with colour and gradient: those that light reaches
  double loss = 0.0;           // mean over rays
  double squared_error = 0.0;  // mean over colour rays and channels, display values
  bool finite = true;          // false: the step was left out
  double gradient_norm = 0.0;  // of the networks' gradient, before it is clipped
  bool clipped = false;        // whether it was
  SaturatedCounts saturated;
};

class FieldStep {
 public:
  // Of `target` only map, step and colour range are read; its parameters are given to every step. context: not trained; may be null.
  FieldStep(const render::TrainedField& target, const field::HashField& field, const render::TrainedField* context, const LuminancePlan& luminance,
            base::ThreadPool& threads, PhaseTimes& times);

  FieldStep(const FieldStep&) = delete;  // packet trainers refer to it
  FieldStep& operator=(const FieldStep&) = delete;

  // One step on the batch; overwrites positions of the batch. When the gradients are not finite, parameters and moments stay as they were. Gradients
  // by the photos' gains are added to the learner, which may be null; the caller makes its step. The codes learn too; null or off: every ray has the
  // code of the mean look. rays: where not null, gets the gradient by every ray of the batch.
  StepResult Train(RayBatch& batch, const StepOptions& options, field::Parameters& parameters, field::OptimizerState& state,
                   brightness::ResponseLearner* learner, AppearanceCodes* codes = nullptr, RayGradients* rays = nullptr);
  // Only density and colour of every sample, for timing.
  void Infer(RayBatch& batch, const field::Parameters& parameters);
  // Running means with luminance; part of the checkpoint.
  brightness::LuminanceState& luminance_state() { return state_; }
  // Optical depth (tau) of one marching step per sample of the last Train; 0 where no light arrives.
  const std::vector<float>& ObservedTaus() const { return observed_; }

 private:
  // Number of buffers that network gradients are summed in: packet k in buffer k modulo this.
  static constexpr size_t kGradientSlots = 16;

  void Encode(const RayBatch& batch, std::span<const float> grid);
  // Sums the packets' results in their order and lists their gradients.
  LossSums SumResults(float ray_share, StepResult* result);
  // Shortens the networks' gradient to at most twice its running norm, which follows.
  static void ClipNetworkGradient(field::OptimizerState& state, StepResult& result);
  // Adds the slots' gradients to the state's; false when one is not finite.
  bool SumNetworkGradients(field::OptimizerState& state) const;
  // With the gradients of the batch's rays.
  void TrainCodes(const RayBatch& batch, double learning_rate, AppearanceCodes& codes) const;
  void UpdateRunningMeans(const LossSums& sums);

  const field::HashField& field_;
  brightness::Luminance luminance_;
  brightness::LuminanceState state_;
  base::ThreadPool& threads_;
  PhaseTimes& times_;
  field::Optimizer optimizer_;
  PacketShared shared_;
  std::vector<std::unique_ptr<PacketTrainer>> trainers_;  // per thread
  std::vector<float> read_ahead_;                         // per thread
  std::vector<float> features_;                           // per packet; overwritten by their gradient
  std::vector<float> observed_;
  std::vector<PacketResult> results_;
  std::vector<SurfacePoints> surface_points_;  // per packet; empty without losses of normals
  std::vector<float> slot_gradients_;
  std::vector<std::array<float, 3>> gain_gradients_;  // per ray, by its log gains; empty without a learner
  std::vector<float> code_gradients_;                 // per ray, by the code of its photo; empty without codes
  std::vector<field::FeatureGradient> gradient_segments_;
};

}  // namespace skyquilt::worker
