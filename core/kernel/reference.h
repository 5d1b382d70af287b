// Scalar versions of the kernels for float or double. The kernels are tested against them, and their gradients are checked in double by finite
// differences.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "core/kernel/descriptors.h"
#include "core/kernel/kernels.h"

namespace skyquilt::kernel::reference {

// out = W in for one sample, then max(0, .) when relu.
template <typename T>
std::vector<T> Dense(const std::vector<T>& weights, int n_out, const std::vector<T>& in, bool relu) {
  std::vector<T> out(static_cast<size_t>(n_out), T(0));
  for (size_t o = 0; o < out.size(); ++o) {
    for (size_t i = 0; i < in.size(); ++i) out[o] += weights[o * in.size() + i] * in[i];
    if (relu) out[o] = std::max(out[o], T(0));
  }
  return out;
}

// Backward pass of Dense for one sample: overwrites in_gradient, adds to weight_gradient. `out` is the result of Dense.
template <typename T>
void DenseBackward(const std::vector<T>& weights, const std::vector<T>& in, const std::vector<T>& out, bool relu, std::vector<T> out_gradient,
                   std::vector<T>* in_gradient, std::vector<T>* weight_gradient) {
  in_gradient->assign(in.size(), T(0));
  for (size_t o = 0; o < out.size(); ++o) {
    if (relu && out[o] <= T(0)) out_gradient[o] = T(0);
    for (size_t i = 0; i < in.size(); ++i) {
      (*in_gradient)[i] += weights[o * in.size() + i] * out_gradient[o];
      (*weight_gradient)[o * in.size() + i] += out_gradient[o] * in[i];
    }
  }
}

template <typename T>
struct Corner {
  uint32_t entry;
  T weight;
};

// The eight corners of the cell that contains a position, with trilinear weights; positions are clamped into the lattice.
template <typename T>
std::vector<Corner<T>> Corners(const GridLevel& level, const T position[3]) {
  uint32_t cell[3];
  T fraction[3];
  for (int axis = 0; axis < 3; ++axis) {
    T scaled = position[axis] * static_cast<T>(level.cells_per_unit);
    scaled = scaled > T(0) ? std::min(scaled, static_cast<T>(level.size[axis] - 1)) : T(0);
    cell[axis] = static_cast<uint32_t>(std::min(static_cast<int32_t>(scaled), level.size[axis] - 2));
    fraction[axis] = scaled - static_cast<T>(cell[axis]);
  }
  std::vector<Corner<T>> corners;
  for (uint32_t c = 0; c < 8; ++c) {
    T weight = T(1);
    uint32_t at[3];
    for (uint32_t axis = 0; axis < 3; ++axis) {
      const uint32_t bit = (c >> axis) & 1U;
      at[axis] = cell[axis] + bit;
      weight *= bit != 0 ? fraction[axis] : T(1) - fraction[axis];
    }
    corners.push_back({HashIndex(level, at[0], at[1], at[2]), weight});
  }
  return corners;
}

template <typename T>
std::vector<T> HashForward(const GridLevel& level, int features, const std::vector<T>& table, const T position[3]) {
  std::vector<T> out(static_cast<size_t>(features), T(0));
  for (const Corner<T>& corner : Corners(level, position)) {
    for (size_t f = 0; f < out.size(); ++f) out[f] += corner.weight * table[corner.entry * out.size() + f];
  }
  return out;
}

template <typename T>
void HashBackward(const GridLevel& level, const T position[3], const std::vector<T>& out_gradient, std::vector<T>* table_gradient) {
  for (const Corner<T>& corner : Corners(level, position)) {
    for (size_t f = 0; f < out_gradient.size(); ++f) (*table_gradient)[corner.entry * out_gradient.size() + f] += corner.weight * out_gradient[f];
  }
}

// One sample: mean over its positions, times the weight of its footprint (kernel::Positions::sharpness; infinite: a point).
template <typename T>
T FootprintShare(const GridLevel& level, T sharpness, size_t positions) {
  return std::erf(sharpness / static_cast<T>(level.cells_per_unit)) / static_cast<T>(positions);
}

template <typename T>
std::vector<T> HashForward(const GridLevel& level, int features, const std::vector<T>& table, const std::vector<std::array<T, 3>>& positions,
                           T sharpness) {
  std::vector<T> out(static_cast<size_t>(features), T(0));
  for (const std::array<T, 3>& position : positions) {
    const std::vector<T> one = HashForward(level, features, table, position.data());
    for (size_t f = 0; f < out.size(); ++f) out[f] += FootprintShare(level, sharpness, positions.size()) * one[f];
  }
  return out;
}

template <typename T>
void HashBackward(const GridLevel& level, const std::vector<std::array<T, 3>>& positions, T sharpness, std::vector<T> out_gradient,
                  std::vector<T>* table_gradient) {
  for (T& g : out_gradient) g *= FootprintShare(level, sharpness, positions.size());
  for (const std::array<T, 3>& position : positions) HashBackward(level, position.data(), out_gradient, table_gradient);
}

// One value of ExpShifted, SoftplusShifted, ReluShifted, Sigmoid and SineCosine.
template <typename T>
T ExpShifted(T x, T bias, T limit) {
  return std::exp(std::min(limit, x + bias));
}

template <typename T>
T SoftplusShifted(T x, T bias, T most) {
  const T t = x + bias;
  return std::min(most, std::max(T(0), t) + std::log1p(std::exp(-std::abs(t))));
}

template <typename T>
T ReluShifted(T x, T shift, T most) {
  return std::min(most, std::max(T(0), x + shift));
}

template <typename T>
T Sigmoid(T x, T range) {
  return range / (T(1) + std::exp(-x));
}

template <typename T>
void SineCosine(T turns, T* sine, T* cosine) {
  // The nearest whole turn goes off first, which is exact, then the sine is folded about a quarter turn: small results keep all their digits.
  const T t = turns - std::round(turns);
  const T size = std::abs(t);
  *sine = std::copysign(std::sin(T(2) * std::numbers::pi_v<T> * std::min(size, T(0.5) - size)), t);
  *cosine = std::sin(T(2) * std::numbers::pi_v<T> * (T(0.25) - size));
}

// One parameter's step of AdamDense and AdamTouched.
template <typename T>
void Adam(const AdamStep& step, T gradient, T* parameter, T* moment1, T* moment2) {
  const T beta1 = static_cast<T>(step.beta1), beta2 = static_cast<T>(step.beta2);
  *moment1 = (T(1) - beta1) * gradient + beta1 * *moment1;
  *moment2 = (T(1) - beta2) * gradient * gradient + beta2 * *moment2;
  const T denominator = std::sqrt(*moment2 / static_cast<T>(step.correction2)) + static_cast<T>(step.epsilon);
  *parameter -= static_cast<T>(step.learning_rate) / static_cast<T>(step.correction1) * *moment1 / denominator;
}

// One way of FindBestDots: for each descriptor of `of`, among those of `among`.
inline BestDots FindBestDots(std::span<const uint8_t> of, std::span<const uint8_t> among) {
  BestDots best;
  for (size_t i = 0; i < of.size(); i += kDescriptorBytes) {
    std::vector<int32_t> dots(among.size() / kDescriptorBytes, 0);
    for (size_t k = 0; k < among.size(); ++k) dots[k / kDescriptorBytes] += int32_t{of[i + k % kDescriptorBytes]} * int32_t{among[k]};
    const auto most = std::max_element(dots.begin(), dots.end());  // the first of equals
    const bool none = most == dots.end() || *most == 0;
    best.index.push_back(none ? -1 : static_cast<int32_t>(most - dots.begin()));
    best.dot.push_back(none ? 0 : *most);
    if (!none) *most = 0;
    best.second.push_back(none ? 0 : *std::max_element(dots.begin(), dots.end()));
  }
  return best;
}

}  // namespace skyquilt::kernel::reference
