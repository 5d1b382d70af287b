// The interlevel loss of a ray, by which a proposal network learns where the field has matter. A proposal's weights must nowhere be smaller than the
// field's, which are blurred first so that a small shift of a surface changes the loss smoothly (Barron et al. 2023, Zip-NeRF, section 3.3):
//   weight / m * sum_k max(0, v_k - w_k)^2 / (w_k + 1e-5),   v: the field's blurred weights in the proposal's bins, w: the proposal's weights.
// The field gets no gradient. Edges of bins are ascending shares of the ray between its ends, 0..1; bins of no length are legal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace skyquilt::worker {

// Buffers kept between rays, so that nothing is allocated per ray.
struct InterlevelScratch {
  std::vector<double> sum, integral;
};

// The weight of n bins, whose density is blurred with a box of half width `half_width` > 0, within each of m bins: mass[k], k < m. The blurred weight
// up to x is the mean over [x - h, x + h] of the weight up to there, which is linear inside a bin, so its integral is known exactly. In double: it is
// a difference of integrals that agree in most digits.
template <typename T>
void BlurredWeights(size_t n, const T* edges, const T* weights, double half_width, size_t m, const T* bin_edges, InterlevelScratch& scratch,
                    double* mass) {
  scratch.sum.assign(n + 1, 0.0);       // of the weights before each edge
  scratch.integral.assign(n + 1, 0.0);  // of that sum up to each edge
  for (size_t i = 0; i < n; ++i) {
    scratch.sum[i + 1] = scratch.sum[i] + static_cast<double>(weights[i]);
    const double length = static_cast<double>(edges[i + 1]) - static_cast<double>(edges[i]);
    scratch.integral[i + 1] = scratch.integral[i] + 0.5 * length * (scratch.sum[i] + scratch.sum[i + 1]);
  }
  const auto integral_up_to = [&](double x) {
    if (x <= static_cast<double>(edges[0])) return 0.0;
    if (x >= static_cast<double>(edges[n])) return scratch.integral[n] + scratch.sum[n] * (x - static_cast<double>(edges[n]));
    const auto i =
        static_cast<size_t>(std::upper_bound(edges, edges + n + 1, x, [](double at, T edge) { return at < static_cast<double>(edge); }) - edges) - 1;
    const double along = x - static_cast<double>(edges[i]);
    const double density = static_cast<double>(weights[i]) / (static_cast<double>(edges[i + 1]) - static_cast<double>(edges[i]));
    return scratch.integral[i] + along * (scratch.sum[i] + 0.5 * density * along);
  };
  const auto blurred_up_to = [&](T edge) {
    const auto x = static_cast<double>(edge);
    return (integral_up_to(x + half_width) - integral_up_to(x - half_width)) / (2.0 * half_width);
  };
  double before = blurred_up_to(bin_edges[0]);
  for (size_t k = 0; k < m; ++k) {
    const double after = blurred_up_to(bin_edges[k + 1]);
    mass[k] = std::max(0.0, after - before);
    before = after;
  }
}

// field_mass: of BlurredWeights. Adds the derivatives by the proposal's weights to weight_gradient (m); returns the loss. Both contain the factor
// `weight`.
template <typename T>
T AddInterlevelLoss(T weight, size_t m, const double* field_mass, const T* weights, T* weight_gradient) {
  T loss = T(0);
  const T share = weight / static_cast<T>(std::max<size_t>(1, m));
  for (size_t k = 0; k < m; ++k) {
    const T missing = static_cast<T>(field_mass[k]) - weights[k];
    if (!(missing > T(0))) continue;
    const T by = T(1) / (weights[k] + T(1e-5));
    loss += share * missing * missing * by;
    weight_gradient[k] -= share * missing * by * (T(2) + missing * by);
  }
  return loss;
}

}  // namespace skyquilt::worker
