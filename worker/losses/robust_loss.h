// Pulls a distance towards zero, but lets go of distances that are too large for the assumption to be true (Geman and McClure 1985).
#pragma once

#include "worker/losses/loss.h"

namespace skyquilt::worker {

// weight * s^2 / (1 + s^2 / kappa^2) and its derivative by s. s: any unit, kappa > 0: the same unit; far beyond kappa the loss is constant.
template <typename T>
Loss<T> RobustLoss(T weight, T s, T kappa) {
  const T spread = T(1) + s * s / (kappa * kappa);
  return {weight * s * s / spread, T(2) * weight * s / (spread * spread)};
}

}  // namespace skyquilt::worker
