// Table of the error function for FootprintWeight (kernels.h): an erf per sample and level would cost more than the lookup of its features.
#pragma once

#include <array>
#include <cmath>

namespace skyquilt::kernel {

constexpr int kFootprintStepsPerUnit = 256;                  // linear interpolation is then within 2e-6
constexpr int kFootprintSteps = 4 * kFootprintStepsPerUnit;  // erf(4) is 1 as float

// erf(i / kFootprintStepsPerUnit), i = 0 .. kFootprintSteps.
inline const float* FootprintTable() {
  static const std::array<float, kFootprintSteps + 1> table = [] {
    std::array<float, kFootprintSteps + 1> values{};
    for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(std::erf(static_cast<double>(i) / kFootprintStepsPerUnit));
    return values;
  }();
  return table.data();
}

}  // namespace skyquilt::kernel
