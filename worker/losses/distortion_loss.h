// The distortion loss of a ray (Barron et al. 2022, eq. 15), which concentrates its density at one distance and so suppresses floaters.
#pragma once

#include <cstddef>
#include <vector>

#include "core/render/composite.h"

namespace skyquilt::worker {

// Buffers kept between rays, so that nothing is allocated per ray.
template <typename T>
struct DistortionScratch {
  std::vector<T> mid, width;
};

// n >= 1 samples of one ray: compositing weights, and distances t (metres, ascending) of intervals of length step_m, times steps[i] unless `steps` is
// null. per_metre: units of the loss's distances per metre. Adds the derivatives by the compositing weights to weight_gradient (n); returns the loss.
// Both contain the factor `weight`.
template <typename T>
T AddDistortionLoss(T weight, size_t n, const T* weights, const T* t, T step_m, const T* steps, T per_metre, DistortionScratch<T>& scratch,
                    T* weight_gradient) {
  scratch.mid.resize(n);
  scratch.width.assign(n, step_m * per_metre);
  for (size_t i = 0; steps != nullptr && i < n; ++i) scratch.width[i] *= steps[i];
  for (size_t i = 0; i < n; ++i) scratch.mid[i] = (t[i] - t[0]) * per_metre;
  return render::DistortionLoss(static_cast<int>(n), weights, scratch.mid.data(), scratch.width.data(), weight, weight_gradient);
}

}  // namespace skyquilt::worker
