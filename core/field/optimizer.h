// Adam over the two parameter groups of a field. Grid entries without a gradient in a step keep their parameters and moments
// (tiny-cuda-nn's rule); the networks carry a small L2 term.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/field/hash_field.h"

namespace skyquilt::field {

// Parameters, moments and gradient buffers of one field in training.
struct TrainableState {
  std::vector<float> grid, networks;
  std::vector<float> grid_moment1, grid_moment2, network_moment1, network_moment2;
  int64_t step = 0;  // updates done

  // Not saved: zero between steps.
  std::vector<float> grid_gradient, network_gradient;
  std::vector<uint8_t> touched;  // per line of kernel::kLineFloats grid parameters

  void Allocate(const HashField& field);
};

// Told at the end of every task which thread did it and when it began; may be empty.
using TaskClock = std::function<void(int thread, std::chrono::steady_clock::time_point began)>;

// Samples of one batch in stretches, as packets leave them.
struct GridGradient {
  int64_t begin = 0, count = 0;     // in x, y, z
  const float* gradient = nullptr;  // FeatureRows() rows
  size_t stride = 0;
};
// Adds the gradient of the samples' features to the grid. Each level belongs to one task, so bits do not depend on the thread count.
void AccumulateGrid(const HashField& field, const float* x, const float* y, const float* z, std::span<const GridGradient> stretches,
                    TrainableState& state, base::ThreadPool& threads, const TaskClock& clock = {});
// One update; clears the gradients. network_l2 is the weight decay of the networks.
void ApplyAdam(const HashField& field, double learning_rate, double network_l2, TrainableState& state, base::ThreadPool& threads,
               const TaskClock& clock = {});
// Forgets this step's gradients without an update.
void DropGradients(TrainableState& state);

}  // namespace skyquilt::field
