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
#include "core/field/parameters.h"

namespace skyquilt::field {

// What training keeps beside a field's parameters: their moments and the gradient buffer.
struct TrainableState {
  std::vector<float> grid_moment1, grid_moment2, network_moment1, network_moment2;
  int64_t step = 0;  // updates done

  std::vector<float> network_gradient;  // not saved: zero between steps

  void Allocate(const HashField& field);
};

// Samples of one batch in segments, as packets leave them.
struct GridGradient {
  int64_t begin = 0, count = 0;     // in x, y, z
  const float* gradient = nullptr;  // FeatureRows() rows
  size_t stride = 0;
};
// Adds the gradient of the samples' features to the table gradient of one part of the encoding, whose parameters begin at `table`, and marks the
// lines written to (encoding::Encoding::Backward).
void AddPartGradient(const HashField& field, int part, const float* table, const float* x, const float* y, const float* z,
                     std::span<const GridGradient> segments, float* table_gradient, uint8_t* touched);

// Told at the end of a piece of work which thread did it and when it began; may be empty.
using TaskClock = std::function<void(int thread, std::chrono::steady_clock::time_point began)>;

// Updates a field from a batch. The gradient of a part of the encoding (a level of a hash grid) lives only from its samples to its parameters, in one
// buffer per thread that stays in cache from part to part. Each part belongs to one thread, so bits do not depend on their number.
class Optimizer {
 public:
  Optimizer(const HashField& field, base::ThreadPool& threads);
  // One step of Adam with state.network_gradient, which is cleared, and the grid gradient of the segments. network_l2 is the weight decay of
  // the networks.
  void Update(const float* x, const float* y, const float* z, std::span<const GridGradient> segments, double learning_rate, double network_l2,
              Parameters& parameters, TrainableState& state, const TaskClock& scattered = {}, const TaskClock& applied = {});

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
