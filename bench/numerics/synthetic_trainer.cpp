#include "bench/numerics/synthetic_trainer.h"

#include <algorithm>
#include <utility>

namespace skyquilt::bench {

SyntheticTrainer::SyntheticTrainer(const SyntheticOptions& scene, uint64_t seed, int threads)
    : scene_(scene),
      threads_(threads),
      times_(threads_.size()),
      target_(SyntheticField(scene)),
      field_(target_.config),
      state_(InitialState(field_, seed)),
      codes_(static_cast<size_t>(scene.photos), scene.appearance),
      step_(target_, field_, nullptr, {}, threads_, times_) {}

worker::RayBatch SyntheticTrainer::Draw(const SyntheticRays& rays, base::Random& random) const {
  worker::RayBatch batch;
  DrawSyntheticBatch(target_, scene_, rays, random, &batch);
  return batch;
}

SyntheticTrainer::Gradients SyntheticTrainer::GradientsOf(worker::RayBatch batch, double distortion) {
  return GradientsOf(std::move(batch), worker::StepOptions{.learning_rate = 0.0, .network_l2 = 0.0, .distortion = distortion});
}

SyntheticTrainer::Gradients SyntheticTrainer::GradientsOf(worker::RayBatch batch, const worker::StepPriors& priors) {
  return GradientsOf(std::move(batch), worker::StepOptions{.priors = priors});
}

SyntheticTrainer::Gradients SyntheticTrainer::GradientsOf(worker::RayBatch batch, const worker::StepOptions& options) {
  // After one step from zero moments, the first moment is a tenth of the gradient.
  field::Parameters parameters = state_.parameters;
  field::OptimizerState probe;
  probe.Allocate(field_);
  worker::AppearanceCodes codes = codes_;
  std::fill(codes.state().moment1.begin(), codes.state().moment1.end(), 0.0F);
  Gradients gradients;
  gradients.result = step_.Train(batch, options, parameters, probe, nullptr, &codes);
  const auto share = static_cast<double>(1.0F - kernel::AdamStep{}.beta1);
  for (const float moment : probe.grid_moment1) gradients.grid.push_back(static_cast<double>(moment) / share);
  for (const float moment : probe.network_moment1) gradients.networks.push_back(static_cast<double>(moment) / share);
  for (const float moment : codes.state().moment1) gradients.codes.push_back(static_cast<double>(moment) / share);
  return gradients;
}

}  // namespace skyquilt::bench
