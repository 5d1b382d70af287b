// Losses of rays towards a known point. The first concentrates the compositing weights of a ray around a known distance of uncertain size (Deng et
// al. 2022, DS-NeRF, eq. 6: the divergence of the ray's distribution from a normal distribution; sigma enters squared).
#pragma once

#include <cmath>
#include <cstddef>

namespace skyquilt::worker {

// -weight * sum_k log(w_k + epsilon) g_k with g_k = exp(-(t_k - distance)^2 / (2 sigma^2)) step / (sigma sqrt(2 pi)), over n samples at t_k (metres)
// with intervals of `step` metres. Adds the derivatives by the compositing weights w_k to weight_gradient (n); returns the loss.
// epsilon: keeps empty samples from dominating. sigma > 0.
template <typename T>
T AddPointDepthLoss(T weight, size_t n, const T* weights, const T* t, T step, T distance, T sigma, T* weight_gradient) {
  constexpr T kEpsilon = T(1e-2F), kRootTwoPi = T(2.5066283F);
  T loss = T(0);
  for (size_t k = 0; k < n; ++k) {
    const T off = (t[k] - distance) / sigma;
    const T g = weight * std::exp(T(-0.5F) * off * off) * step / (sigma * kRootTwoPi);
    loss -= std::log(weights[k] + kEpsilon) * g;
    weight_gradient[k] -= g / (weights[k] + kEpsilon);
  }
  return loss;
}

// weight times the light that is stopped before the distance `free_to`, as light from the point came through: sum of w_k over t_k < free_to (metres).
// Adds the derivatives by w_k to weight_gradient (n); returns the loss. t ascends.
template <typename T>
T AddFreeSpaceLoss(T weight, size_t n, const T* weights, const T* t, T free_to, T* weight_gradient) {
  T loss = T(0);
  for (size_t k = 0; k < n && t[k] < free_to; ++k) {
    loss += weight * weights[k];
    weight_gradient[k] += weight;
  }
  return loss;
}

}  // namespace skyquilt::worker
