// In badly exposed photos most pixels are nearly black or nearly white, and a squared error of display values hardly sees their differences. The
// inverse tone curve Phi(x) = 1/2 - sin(asin(1 - 2x) / 3) spreads values near 0 and 1, so that errors there count.
// x: display value. The slope is unbounded at 0 and 1, so the curve is continued by its tangent closer than kSafe to either end: value and slope
// are finite and the curve rises for every finite x. The published code clips x instead, which gives clipped pixels no gradient.
// In float, from -4 to 4: the value within 2.3 ulp or 1.9e-7, whichever is more (small values are differences of numbers near a half); the slope
// within 4.1 ulp.
// Source: Cui et al. 2024, Aleth-NeRF, eq. 11; tidal-flat paper, eq. 14.
#pragma once

#include <algorithm>
#include <cmath>

namespace skyquilt::brightness {

constexpr float kSafe = 1e-3F;

template <typename T>
struct TonedValue {
  T value;  // Phi(x)
  T slope;  // d Phi / d x
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
