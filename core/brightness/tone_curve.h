// The inverse tone curve Phi(x) = 1/2 - sin(asin(1 - 2x) / 3) (Cui et al. 2024, Aleth-NeRF, eq. 11; tidal-flat paper, eq. 14). It spreads dark
// and bright values, so that errors there count. Its slope is unbounded at 0 and 1: beyond kSafe of either end the curve goes on as the
// straight line it has there, which keeps value and slope finite and the curve rising for every finite x. The published code clips its
// argument instead, and a clipped pixel stops learning.
// In float, from -4 to 4: the value within 2.3 ulp or 1.9e-7, whichever is more (small values are differences of numbers near a half); the slope
// within 4.1 ulp.
#pragma once

#include <algorithm>
#include <cmath>

namespace skyquilt::brightness {

constexpr float kSafe = 1e-3F;

template <typename T>
struct TonedValue {
  T value;
  T slope;
};
using Toned = TonedValue<float>;

template <typename T>
TonedValue<T> ToneCurve(T x) {
  const T inside = std::clamp(x, T(kSafe), T(1) - T(kSafe));
  const T angle = std::asin(T(1) - T(2) * inside) / T(3);
  const T slope = std::cos(angle) / (T(3) * std::sqrt(inside * (T(1) - inside)));
  return {T(0.5) - std::sin(angle) + slope * (x - inside), slope};
}

}  // namespace skyquilt::brightness
