// Volume rendering of one ray: composites the samples' colours front to back, and propagates gradients back to them.
//   T_0 = 1, T_{i+1} = T_i exp(-tau_i), w_i = T_i - T_{i+1}, C = sum_i w_i c_i            (Max 1995; Mildenhall et al. 2020, eq. 3)
//   dL/dtau_i = T_{i+1} g_i - sum_{j>i} w_j g_j - T_n dL/dT_n,   g_i = dL/dC . c_i + dL/dw_i
// tau >= 0: optical depth of an interval; infinity is legal. T_n: transmittance behind the last sample. color: 3 rows, one per channel, of stride
// `stride`.
// In float the weight of a ray's first sample is within 4.6e-8, the transmittance behind it within 0.6 ulp. Weights are differences of
// transmittances, not T_i (-expm1(-tau_i)): thin samples lose digits, those of tau < 2.9e-8 all, but the weights sum to 1 - T_n.
#pragma once

#include <cmath>
#include <cstddef>

namespace skyquilt::render {

// Where in an interval of even density its light is stopped on average, as a share of its length: 1/2 for tau near 0, towards 0 for large ones, whose
// light is stopped at the front.
template <typename T>
T MeanStop(T tau) {
  // Below, the difference loses digits; above, the second term is 0.
  if (tau < T(0.02)) return T(0.5) - tau / T(12);
  return tau < T(80) ? T(1) / tau - T(1) / std::expm1(tau) : T(1) / tau;
}

// Writes weights (n) and rgb; returns the transmittance behind the last sample. n = 0 gives 1 and black.
template <typename T>
T CompositeForward(int n, const T* tau, const T* color, size_t stride, T* weights, T rgb[3]) {
  T transmittance = T(1);
  rgb[0] = rgb[1] = rgb[2] = T(0);
  for (int i = 0; i < n; ++i) {
    const T after = transmittance * std::exp(-tau[i]);
    weights[i] = transmittance - after;
    for (int c = 0; c < 3; ++c) rgb[c] += weights[i] * color[static_cast<size_t>(c) * stride + static_cast<size_t>(i)];
    transmittance = after;
  }
  return transmittance;
}

// weights, final_transmittance: from CompositeForward. transmittance_gradient: dL/dT_n. weight_gradient: further dL/dw_i, may be null.
// Writes tau_gradient (n) and color_gradient (3 rows of stride gradient_stride).
template <typename T>
void CompositeBackward(int n, const T* color, size_t stride, const T* weights, T final_transmittance, const T rgb_gradient[3],
                       T transmittance_gradient, const T* weight_gradient, T* tau_gradient, T* color_gradient, size_t gradient_stride) {
  T behind = final_transmittance * transmittance_gradient;  // sum of w_j g_j over all samples behind, plus T_n dL/dT_n
  T after = final_transmittance;
  for (int i = n - 1; i >= 0; --i) {
    T g = weight_gradient != nullptr ? weight_gradient[i] : T(0);
    for (int c = 0; c < 3; ++c) {
      g += rgb_gradient[c] * color[static_cast<size_t>(c) * stride + static_cast<size_t>(i)];
      color_gradient[static_cast<size_t>(c) * gradient_stride + static_cast<size_t>(i)] = weights[i] * rgb_gradient[c];
    }
    tau_gradient[i] = after * g - behind;
    behind += weights[i] * g;
    after += weights[i];
  }
}

// Distortion loss of one ray (Barron et al. 2022, eq. 15), which concentrates the weights at one distance and so suppresses floaters:
//   sum_ij w_i w_j |m_i - m_j| + 1/3 sum_i w_i^2 d_i,   m: interval midpoints, ascending; d: interval widths; both in the caller's unit.
// Adds scale * dL/dw to weight_gradient; returns scale * loss.
template <typename T>
T DistortionLoss(int n, const T* weights, const T* mid, const T* width, T scale, T* weight_gradient) {
  T total_weight = T(0), total_moment = T(0);
  for (int i = 0; i < n; ++i) {
    total_weight += weights[i];
    total_moment += weights[i] * mid[i];
  }
  T loss = T(0), weight_before = T(0), moment_before = T(0);
  for (int i = 0; i < n; ++i) {
    const T weight_after = total_weight - weight_before - weights[i];
    const T moment_after = total_moment - moment_before - weights[i] * mid[i];
    const T pull = mid[i] * weight_before - moment_before + moment_after - mid[i] * weight_after;  // sum_j w_j |m_i - m_j|
    loss += weights[i] * pull + weights[i] * weights[i] * width[i] / T(3);
    weight_gradient[i] += scale * (T(2) * pull + T(2) * weights[i] * width[i] / T(3));
    weight_before += weights[i];
    moment_before += weights[i] * mid[i];
  }
  return scale * loss;
}

}  // namespace skyquilt::render
