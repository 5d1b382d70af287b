// Data for the kernel benchmarks: random arrays that are the same on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "core/base/system.h"

namespace skyquilt::bench {

inline void FillRandom(std::vector<float>& values, float low, float high, uint64_t seed) {
  base::Random random(seed);
  for (float& value : values) value = low + (high - low) * random.Uniform();
}

inline std::vector<float> RandomValues(size_t n, float low, float high, uint64_t seed = 1) {
  std::vector<float> values(n);
  FillRandom(values, low, high, seed);
  return values;
}

// Zeros, on large pages if the system has them, as in field::AssignTable.
inline std::vector<float> Table(size_t n) {
  std::vector<float> values;
  values.reserve(n);
  base::AdviseHugePages(values.data(), n * sizeof(float));
  values.assign(n, 0.0F);
  return values;
}

}  // namespace skyquilt::bench
