// A ray that is known to meet nothing in the field should pass through it.
#pragma once

#include "worker/losses/loss.h"

namespace skyquilt::worker {

// weight * (1 - transmittance)^2, transmittance 0..1.
template <typename T>
Loss<T> EmptinessLoss(T weight, T transmittance) {
  const T opacity = T(1) - transmittance;
  return {weight * (opacity * opacity), T(-2) * weight * opacity};
}

}  // namespace skyquilt::worker
