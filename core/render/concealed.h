// The concealed rendering of a concealing field (core/brightness/luminance.h; tidal-flat paper, eq. 12-13): turns the samples' factors Omega into the
// share of its light that each sample shows. Densities and compositing weights are those of the plain rendering. Colours are linear light here.
//   gain     share_i = Omega_i                 (as in the published code of the method)
//   product  share_i = prod_{j < i} Omega_j    (eq. 13 as printed: the samples in front dim the light of those behind)
#pragma once

#include <cstddef>

namespace skyquilt::render {

enum class Concealing { kNone = 0, kGain = 1, kProduct = 2 };

// omega, share: n samples, front to back.
template <typename T>
void LightShares(Concealing concealing, int n, const T* omega, T* share) {
  T passed = T(1);
  for (int i = 0; i < n; ++i) {
    share[i] = concealing == Concealing::kProduct ? passed : omega[i];
    passed *= omega[i];
  }
}

// d loss / d Omega from d loss / d share. omega > 0.
template <typename T>
void LightSharesBackward(Concealing concealing, int n, const T* omega, const T* share, const T* share_gradient, T* omega_gradient) {
  T behind = T(0);
  for (int i = n - 1; i >= 0; --i) {
    omega_gradient[i] = concealing == Concealing::kProduct ? behind / omega[i] : share_gradient[i];
    behind += share[i] * share_gradient[i];
  }
}

}  // namespace skyquilt::render
