// Keeps a number, of one ray or a mean over many, near its goal.
#pragma once

#include "worker/losses/loss.h"

namespace skyquilt::worker {

// weight * off^2 and its derivative by off. off: the number minus its goal.
template <typename T>
Loss<T> MeanLoss(T weight, T off) {
  return {weight * off * off, T(2) * weight * off};
}

}  // namespace skyquilt::worker
