// Trains one field step by step: draws rays, lets FieldStep learn from them, keeps occupancy and batch size up to date.
// Bits do not depend on the number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/field/optimizer.h"
#include "core/render/trained_field.h"
#include "worker/field_step.h"
#include "worker/ray_batch.h"
#include "worker/ray_source.h"
#include "worker/train_options.h"

namespace skyquilt::worker {

class FieldTrainer {
 public:
  // Trains target.parameters in place; they are allocated here, and all zero until InitializeParameters() or a checkpoint fills them. context may
  // be null, and so may learner: the photos' brightness then stays as it is.
  FieldTrainer(render::TrainedField& target, RaySource& source, const render::TrainedField* context, const TrainOptions& options, uint64_t seed,
               const LuminancePlan& luminance, brightness::ResponseLearner* learner, base::ThreadPool& threads);

  field::TrainableState& state() { return state_; }
  int& rays_per_step() { return rays_per_step_; }
  brightness::LuminanceState& luminance_state() { return step_.luminance_state(); }
  void InitializeParameters();

  // progress in [0, 1] of the budget sets learning rate and distortion loss.
  StepResult Step(double progress, double learning_rate_scale);
  // Looks for matter in cells that are not sampled, then decides which cells are. `grow` also wakes the cells around surfaces.
  void UpdateOccupancy(bool grow);
  // Seconds of work per phase (kPhaseNames) since the start, summed over threads.
  std::array<double, kPhases> PhaseSeconds() const { return times_.Seconds(); }

 private:
  void ObserveSamples();
  // Optical depth of one marching step at unit positions (SoA, n).
  void StepDepths(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, std::vector<float>* depth);

  render::TrainedField& target_;
  TrainOptions options_;
  double start_log_gain_;  // of Omega
  uint64_t seed_;
  base::ThreadPool& threads_;
  PhaseTimes times_;
  field::HashField field_;
  field::TrainableState state_;
  RayDrawer drawer_;
  FieldStep step_;
  brightness::ResponseLearner* learner_;
  RaySource& source_;
  RayBatch batch_;
  int rays_per_step_ = 1024;
};

}  // namespace skyquilt::worker
