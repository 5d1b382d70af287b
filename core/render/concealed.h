// Rendering with held-back light (tidal-flat paper, eq. 12-13): the samples' factors Omega turned into the share of light each sample shows.
// Densities and compositing weights are the plain rendering's. Colours are linear light here.
//   gain     share_i = Omega_i                 (what the published code of the method does)
//   product  share_i = prod_{j < i} Omega_j    (eq. 13 as printed: what lies in front holds the light back)
#pragma once

#include <cstddef>

namespace skyquilt::render {

enum class Concealing { kNone = 0, kGain = 1, kProduct = 2 };

// n samples front to back.
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
