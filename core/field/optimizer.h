// Trains the parameters of a field with Adam. Grid parameters without a gradient in a step keep their value and moments (as in tiny-cuda-nn); the
// networks have a small L2 decay.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/field/hash_field.h"
#include "core/field/parameters.h"

namespace skyquilt::field {

// State of the optimiser: the moments of all parameters, and the gradient of the networks.
struct OptimizerState {
  std::vector<float> grid_moment1, grid_moment2, network_moment1, network_moment2;
  int64_t step = 0;                    // updates done
  double network_gradient_norm = 0.0;  // running mean, by which the trainer clips; 0: not known yet

  std::vector<float> network_gradient;  // zero between steps, so not saved

  void Allocate(const HashField& field);
};

// Gradient with respect to the features of a packet of samples; a batch consists of several.
struct FeatureGradient {
  int64_t begin = 0, count = 0;     // in the batch
  const float* gradient = nullptr;  // FeatureRows() rows
  size_t stride = 0;
  // Not null: `gradient` is that of the features' growth along these directions (HashField::DensityGradientBackward), 3 rows of `stride`.
  const float* along = nullptr;
  // Not null: the segment has positions of its own instead of those of the batch.
  const kernel::Positions* at = nullptr;
};
// Backward pass of one part of the encoding over all segments of a batch; table, table_gradient and touched as in encoding::Encoding::Backward.
void AddPartGradient(const HashField& field, int part, const float* table, const kernel::Positions& at, std::span<const FeatureGradient> segments,
                     float* table_gradient, uint8_t* touched);

// Called at the end of a task with its thread and start time, to measure times per phase; may be empty.
using TaskClock = std::function<void(int thread, std::chrono::steady_clock::time_point began)>;

// Updates a field from a batch. A full gradient of the encoding is never stored: each thread takes one part (a level of a hash grid), collects the
// part's gradient in a buffer that stays in cache, and updates the part's parameters. Each part is processed by one thread, so that the result does
// not depend on the number of threads.
class Optimizer {
 public:
  Optimizer(const HashField& field, base::ThreadPool& threads);
  // One step of Adam with state.network_gradient, which is then set to zero, and the grid gradient of the segments. at: positions of the batch.
  // network_l2: weight decay of the networks. `scattered` and `applied` time the backward pass and Adam of each part.
  void Update(const kernel::Positions& at, std::span<const FeatureGradient> segments, double learning_rate, double network_l2, Parameters& parameters,
              OptimizerState& state, const TaskClock& scattered = {}, const TaskClock& applied = {});

 private:
  struct PartScratch {
    std::vector<float> gradient;   // of the largest part
    std::vector<uint8_t> touched;  // per line of it
  };
  const HashField& field_;
  base::ThreadPool& threads_;
  std::vector<PartScratch> scratch_;  // per thread, allocated when first needed; zero between parts
};

}  // namespace skyquilt::field
