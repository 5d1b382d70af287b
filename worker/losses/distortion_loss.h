// Draws the matter along a ray together (Barron et al. 2022, eq. 15), with distances in units of the caller's choice.
#pragma once

#include <cstddef>
#include <vector>

#include "core/render/composite.h"

namespace skyquilt::worker {

// Kept between rays so that nothing is allocated for each.
template <typename T>
struct DistortionScratch {
  std::vector<T> mid, width;
};

// n >= 1 samples of one ray with compositing weights, at distances t (metres, ascending), all of them step_m long; per_metre: units per metre.
// Adds the derivatives by the compositing weights to weight_gradient (n); returns the loss.
template <typename T>
T AddDistortionLoss(T weight, size_t n, const T* weights, const T* t, T step_m, T per_metre, DistortionScratch<T>& scratch, T* weight_gradient) {
  scratch.mid.resize(n);
  scratch.width.assign(n, step_m * per_metre);
  for (size_t i = 0; i < n; ++i) scratch.mid[i] = (t[i] - t[0]) * per_metre;
  return render::DistortionLoss(static_cast<int>(n), weights, scratch.mid.data(), scratch.width.data(), weight, weight_gradient);
}

}  // namespace skyquilt::worker
