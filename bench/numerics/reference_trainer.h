// Reference implementation of the training step, to check worker::FieldStep: same field and batches, but in double and one ray after the other.
// Sample positions, the rule for hidden samples, losses, Adam and its rule for untouched entries are the same; the arithmetic is written
// independently from the formulas.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/numerics/reference_field.h"
#include "bench/numerics/synthetic_scene.h"
#include "core/render/trained_field.h"
#include "worker/rays/ray_batch.h"
#include "worker/step/field_step.h"

namespace skyquilt::bench {

struct ReferenceState {
  std::vector<double> grid, networks;
  std::vector<double> grid_moment1, grid_moment2, network_moment1, network_moment2;
  int64_t step = 0;
  // With FieldConfig::appearance: codes of the photos, [photo][number], and Adam's moments and number of updates.
  std::vector<double> codes, code_moment1, code_moment2;
  std::vector<int64_t> code_steps;

  static ReferenceState From(const TrainingState& state, const worker::AppearanceCodes::State& codes = {});
};

// The place of a batch's sample.
ReferenceField::Place PlaceOf(const kernel::Positions& at, size_t sample);

struct ReferenceResult {
  double loss = 0.0;           // mean over rays
  double squared_error = 0.0;  // mean over colour rays and channels
  int64_t live = 0;            // samples that are not hidden
};

class ReferenceTrainer {
 public:
  // Both must outlive this. Of the target, only map, step, colour range, density activation and whether it has cones are used.
  ReferenceTrainer(const render::TrainedField& target, const field::HashField& field);

  // The loss of a batch and its gradient by every parameter, without weight decay (the optimiser adds it). Gradients are overwritten; null: not
  // needed.
  ReferenceResult Gradient(const worker::RayBatch& batch, const ReferenceState& state, double distortion, std::vector<double>* grid_gradient,
                           std::vector<double>* network_gradient, std::vector<double>* code_gradient = nullptr) const;
  ReferenceResult Step(const worker::RayBatch& batch, const worker::StepOptions& options, ReferenceState& state) const;

 private:
  // One ray; adds to the gradients.
  ReferenceResult Ray(const worker::RayBatch& batch, const worker::BatchRay& ray, const ReferenceState& state, double ray_share, double distortion,
                      std::vector<double>* grid_gradient, std::vector<double>* network_gradient, std::vector<double>* code_gradient) const;
  // Adam on the codes of the batch's photos, then their mean over all that were ever drawn becomes zero.
  void StepCodes(const worker::RayBatch& batch, double learning_rate, const std::vector<double>& gradient, ReferenceState& state) const;
  size_t CodeNumbers() const { return static_cast<size_t>(target_.config.appearance); }

  const render::TrainedField& target_;
  ReferenceField reference_;
};

}  // namespace skyquilt::bench
