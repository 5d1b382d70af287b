// Adam over the two parameter groups of a field. Grid entries without a gradient in a step keep their parameters and moments
// (tiny-cuda-nn's rule); the networks carry a small L2 term.
#pragma once

#include <cstdint>
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
  std::vector<uint8_t> touched;  // per grid entry
  std::vector<uint32_t> list;    // per level, at EntryOffset(level)
  std::vector<uint32_t> listed;  // per level

  void Allocate(const HashField& field);
};

// Adds the gradient of n samples' features to the grid. Each level belongs to one task, so bits do not depend on the thread count.
void AccumulateGrid(const HashField& field, const float* x, const float* y, const float* z, int64_t n, const float* feature_gradient, size_t stride,
                    TrainableState& state, base::ThreadPool& threads);
// One update; clears the gradients. network_l2 is the weight decay of the networks.
void ApplyAdam(const HashField& field, double learning_rate, double network_l2, TrainableState& state, base::ThreadPool& threads);
// Forgets this step's gradients without an update.
void DropGradients(TrainableState& state);

}  // namespace skyquilt::field
