// Makes the field transparent along rays that are known to meet no surface in it, so that no floaters remain there.
#pragma once

#include "worker/losses/loss.h"

namespace skyquilt::worker {

// weight * (1 - transmittance)^2 and its derivative by transmittance, which is 0..1.
template <typename T>
Loss<T> EmptinessLoss(T weight, T transmittance) {
  const T opacity = T(1) - transmittance;
  return {weight * (opacity * opacity), T(-2) * weight * opacity};
}

}  // namespace skyquilt::worker
