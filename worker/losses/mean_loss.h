// Keeps a number, of one ray or of many, near where it should be.
#pragma once

#include "worker/losses/loss.h"

namespace skyquilt::worker {

// weight * off^2, off: what the number is above its goal.
template <typename T>
Loss<T> MeanLoss(T weight, T off) {
  return {weight * off * off, T(2) * weight * off};
}

}  // namespace skyquilt::worker
