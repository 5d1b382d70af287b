// The inverse tone curve Phi(x) = 1/2 - sin(asin(1 - 2x) / 3) (Cui et al. 2024, Aleth-NeRF, eq. 11; tidal-flat paper, eq. 14). It spreads dark
// and bright values, so that errors there count. Its slope is unbounded at 0 and 1: beyond kSafe of either end the curve goes on as the
// straight line it has there, which keeps value and slope finite and the curve rising for every finite x. The published code clips its
// argument instead, and a clipped pixel stops learning.
#pragma once

#include <algorithm>
#include <cmath>

namespace skyquilt::brightness {

constexpr float kSafe = 1e-3F;

struct Toned {
  float value;
  float slope;
};

inline Toned ToneCurve(float x) {
  const float inside = std::clamp(x, kSafe, 1.0F - kSafe);
  const float angle = std::asin(1.0F - 2.0F * inside) / 3.0F;
  const float slope = std::cos(angle) / (3.0F * std::sqrt(inside * (1.0F - inside)));
  return {0.5F - std::sin(angle) + slope * (x - inside), slope};
}

}  // namespace skyquilt::brightness
