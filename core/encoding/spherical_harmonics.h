// Encodes a unit direction in real spherical harmonics up to degree 4 (bands 0..3, 16 values), for view-dependent colour. Order and signs as in
// Sloan, "Efficient Spherical Harmonic Evaluation", 2013, appendix A2; band 0 is 0.28209479.
#pragma once

namespace skyquilt::encoding {

// degree 1..4 gives degree * degree values in out.
template <typename T>
void SphericalHarmonics(T x, T y, T z, int degree, T* out) {
  out[0] = T(0.28209479177387814);
  if (degree < 2) return;
  out[1] = T(-0.48860251190291987) * y;
  out[2] = T(0.48860251190291987) * z;
  out[3] = T(-0.48860251190291987) * x;
  if (degree < 3) return;
  const T xy = x * y, xz = x * z, yz = y * z, x2 = x * x, y2 = y * y, z2 = z * z;
  out[4] = T(1.0925484305920792) * xy;
  out[5] = T(-1.0925484305920792) * yz;
  out[6] = T(0.94617469575755997) * z2 - T(0.31539156525251999);
  out[7] = T(-1.0925484305920792) * xz;
  out[8] = T(0.54627421529603959) * (x2 - y2);
  if (degree < 4) return;
  out[9] = T(0.59004358992664352) * y * (T(-3) * x2 + y2);
  out[10] = T(2.8906114426405538) * xy * z;
  out[11] = T(0.45704579946446572) * y * (T(1) - T(5) * z2);
  out[12] = T(0.3731763325901154) * z * (T(5) * z2 - T(3));
  out[13] = T(0.45704579946446572) * x * (T(1) - T(5) * z2);
  out[14] = T(1.4453057213202769) * z * (x2 - y2);
  out[15] = T(0.59004358992664352) * x * (-x2 + T(3) * y2);
}

// Backward pass: adds to gradient[3] the derivatives by x, y and z of the sum of out_gradient times SphericalHarmonics, whose polynomials are taken
// as they are off the unit sphere too. Of a change that turns the direction only its part across the direction matters. Source: derivatives of the
// above.
template <typename T>
void SphericalHarmonicsBackward(T x, T y, T z, int degree, const T* out_gradient, T* gradient) {
  const T* const g = out_gradient;
  T dx = T(0), dy = T(0), dz = T(0);
  if (degree >= 2) {
    constexpr T c(0.48860251190291987);
    dx += -c * g[3];
    dy += -c * g[1];
    dz += c * g[2];
  }
  if (degree >= 3) {
    constexpr T a(1.0925484305920792), b(0.94617469575755997), c(0.54627421529603959);
    dx += a * (y * g[4] - z * g[7]) + T(2) * c * x * g[8];
    dy += a * (x * g[4] - z * g[5]) - T(2) * c * y * g[8];
    dz += -a * (y * g[5] + x * g[7]) + T(2) * b * z * g[6];
  }
  if (degree >= 4) {
    constexpr T a(0.59004358992664352), b(2.8906114426405538), c(0.45704579946446572), d(0.3731763325901154), e(1.4453057213202769);
    const T xy = x * y, xz = x * z, yz = y * z, x2 = x * x, y2 = y * y, z2 = z * z;
    dx += T(-6) * a * xy * g[9] + b * yz * g[10] + c * (T(1) - T(5) * z2) * g[13] + T(2) * e * xz * g[14] + T(3) * a * (y2 - x2) * g[15];
    dy += T(3) * a * (y2 - x2) * g[9] + b * xz * g[10] + c * (T(1) - T(5) * z2) * g[11] - T(2) * e * yz * g[14] + T(6) * a * xy * g[15];
    dz += b * xy * g[10] - T(10) * c * (yz * g[11] + xz * g[13]) + d * (T(15) * z2 - T(3)) * g[12] + e * (x2 - y2) * g[14];
  }
  gradient[0] += dx;
  gradient[1] += dy;
  gradient[2] += dz;
}

}  // namespace skyquilt::encoding
