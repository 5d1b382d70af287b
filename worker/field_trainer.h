// Trains one field step by step: draws rays, makes an optimiser step on them (field_step.h), and updates occupancy and batch size.
// Same bits for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/field/optimizer.h"
#include "core/render/trained_field.h"
#include "worker/poses/pose_learner.h"
#include "worker/rays/ray_batch.h"
#include "worker/rays/ray_source.h"
#include "worker/samplers/bin_sampler.h"
#include "worker/step/field_step.h"
#include "worker/step/step_priors.h"
#include "worker/step/step_taus.h"
#include "worker/train_options.h"

namespace skyquilt::worker {

class FieldTrainer {
 public:
  // Trains target.parameters in place. They are allocated here and are zero until InitializeParameters() or LoadSession() sets them. context may be
  // null. learner may be null: the photos' gains are then not learned; poses as well: nor are
  // their poses refined. codes: of the source's photos.
  FieldTrainer(render::TrainedField& target, RaySource& source, const render::TrainedField* context, const TrainOptions& options,
               AppearanceCodes codes, uint64_t seed, const LuminancePlan& luminance, brightness::ResponseLearner* learner, const FieldPriors& priors,
               base::ThreadPool& threads, PoseLearner* poses = nullptr);

  field::OptimizerState& state() { return state_; }
  int& rays_per_step() { return rays_per_step_; }
  brightness::LuminanceState& luminance_state() { return step_.luminance_state(); }
  AppearanceCodes& codes() { return codes_; }
  // Null where poses are not refined.
  PoseLearner* poses() { return poses_; }
  // Call it when the state of poses() was changed from outside.
  void UpdatePoses() {
    if (poses_ != nullptr) poses_->Tell(source_);
  }
  // Call it when the photos' response was changed from outside.
  void UpdateExposures() { source_.UpdateExposures(); }
  void InitializeParameters();

  // Sets the target's range of footprints from rays of its photos. Call it when the occupancy has its initial state.
  void MeasureFootprints();
  // One step. progress: of the budget, 0..1, sets learning rate, distortion loss, priors and levels of the pyramid.
  StepResult Step(double progress, double learning_rate_scale);
  // Samples the density of some free cells, then decides which cells are occupied. grow: also marks the cells around surfaces as occupied. With a
  // sampler of bins it does nothing.
  void UpdateOccupancy(bool grow);
  // Null with the sampler "occupancy". Its proposals are part of the training's state.
  BinSampler* sampler() { return sampler_ ? &*sampler_ : nullptr; }
  // Finds the occupied cells at the end of a training that did not sample by cells, for those who render the field: those in which rays ended
  // (BinSampler::MarkLit) and their neighbours, with the largest density at eight random places of each.
  void FindOccupied();
  // Working time per phase (kPhaseNames) since construction in seconds, summed over threads.
  std::array<double, kPhases> PhaseSeconds() const { return times_.Seconds(); }

 private:
  // With the gradients of the last step.
  void RefinePoses(double progress);
  void ObserveSamples();
  // After a step with a sampler of bins: what it found along its rays.
  void UseFoundWeights(double progress, double learning_rate);
  // Writes tau of one marching step at each position (unit frame, structure of arrays).
  void DensityAt(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, std::vector<float>* depth);

  render::TrainedField& target_;
  TrainOptions options_;
  double start_log_gain_;  // of Omega
  uint64_t seed_;
  base::ThreadPool& threads_;
  PhaseTimes times_;
  field::HashField field_;
  field::OptimizerState state_;
  std::optional<BinSampler> sampler_;
  RayDrawer drawer_;
  FieldStep step_;
  brightness::ResponseLearner* learner_;
  AppearanceCodes codes_;
  PoseLearner* poses_;
  RayGradients ray_gradients_;  // of the last step that refined poses
  FieldPriors priors_;
  RaySource& source_;
  RayBatch batch_;
  int rays_per_step_ = 1024;
  std::vector<StepTaus> evaluators_;  // per thread
  std::vector<float> found_;          // weights of the last step's samples, for the sampler
};

}  // namespace skyquilt::worker
