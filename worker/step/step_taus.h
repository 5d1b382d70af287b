// Evaluates only the density of a field, on the calling thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/field/hash_field.h"

namespace skyquilt::worker {

// Keeps its buffers; one object per thread.
class StepTaus {
 public:
  // Writes the optical depth of one marching step at each of n positions (any n).
  void Evaluate(const field::HashField& field, const field::NetworkWeights& weights, std::span<const float> grid, const kernel::Positions& at,
                int64_t n, float* out);

 private:
  std::vector<float> features_, hidden_, geometry_;
};

}  // namespace skyquilt::worker
