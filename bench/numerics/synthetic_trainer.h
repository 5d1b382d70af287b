// Runs the worker's training step on batches of the synthetic scene.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/numerics/synthetic_scene.h"
#include "core/base/thread_pool.h"
#include "worker/step/field_step.h"

namespace skyquilt::bench {

class SyntheticTrainer {
 public:
  SyntheticTrainer(const SyntheticOptions& scene, uint64_t seed, int threads);
  SyntheticTrainer(const SyntheticTrainer&) = delete;
  SyntheticTrainer& operator=(const SyntheticTrainer&) = delete;

  const render::TrainedField& target() const { return target_; }
  const field::HashField& field() const { return field_; }
  const SyntheticOptions& scene() const { return scene_; }
  TrainingState& state() { return state_; }
  worker::AppearanceCodes& codes() { return codes_; }

  worker::RayBatch Draw(const SyntheticRays& rays, base::Random& random) const;
  // The batch is copied, because training removes the positions of hidden samples.
  worker::StepResult Train(worker::RayBatch batch, const worker::StepOptions& options) {
    return step_.Train(batch, options, state_.parameters, state_.moments, nullptr, &codes_);
  }
  // Loss and gradients at the present parameters, which are not changed.
  struct Gradients {
    worker::StepResult result;
    std::vector<double> grid, networks;
    std::vector<double> codes;  // [photo][number]
  };
  Gradients GradientsOf(worker::RayBatch batch, double distortion);
  // With these priors and without distortion loss.
  Gradients GradientsOf(worker::RayBatch batch, const worker::StepPriors& priors);

 private:
  Gradients GradientsOf(worker::RayBatch batch, const worker::StepOptions& options);

  SyntheticOptions scene_;
  base::ThreadPool threads_;
  worker::PhaseTimes times_;
  render::TrainedField target_;
  field::HashField field_;
  TrainingState state_;
  worker::AppearanceCodes codes_;
  worker::FieldStep step_;
};

}  // namespace skyquilt::bench
