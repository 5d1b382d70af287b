// Colour spaces of FLIP. XYZ is relative to the white point here: white is (1, 1, 1).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/image/srgb.h"

namespace skyquilt::metrics {

using Triple = std::array<float, 3>;
using Matrix3 = std::array<Triple, 3>;

// sRGB primaries and their D65 white, rows X, Y, Z; each row sums to the white point's value.
inline constexpr Matrix3 kXyzFromRgb = {{{0.412386564F, 0.357591490F, 0.180450491F},    //
                                         {0.212636822F, 0.715182981F, 0.072180197F},    //
                                         {0.019330620F, 0.119197164F, 0.950372587F}}};  //
inline constexpr Matrix3 kRgbFromXyz = {
    {{3.241003275F, -1.537398934F, -0.498615861F}, {-0.969224334F, 1.875930071F, 0.041554224F}, {0.055639423F, -0.204011202F, 1.057148933F}}};
inline constexpr Triple kWhite = {0.950428545F, 1.0F, 1.088900371F};

inline Triple Times(const Matrix3& m, const Triple& v) {
  Triple result{};
  for (size_t i = 0; i < 3; ++i) result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return result;
}

inline Triple RelativeXyz(const Triple& rgb_linear) {
  Triple xyz = Times(kXyzFromRgb, rgb_linear);
  for (size_t i = 0; i < 3; ++i) xyz[i] /= kWhite[i];
  return xyz;
}

// Achromatic, red-green and blue-yellow value of linear light, all three linear in it: Y = 116 y - 16, Cx = 500 (x - y), Cz = 200 (y - z).
inline Triple OpponentFromLinear(const Triple& rgb_linear) {
  const auto [x, y, z] = RelativeXyz(rgb_linear);
  return {116.0F * y - 16.0F, 500.0F * (x - y), 200.0F * (y - z)};
}

inline Triple LinearFromOpponent(const Triple& opponent) {
  const float y = (opponent[0] + 16.0F) / 116.0F;
  const Triple xyz = {(y + opponent[1] / 500.0F) * kWhite[0], y * kWhite[1], (y - opponent[2] / 200.0F) * kWhite[2]};
  return Times(kRgbFromXyz, xyz);
}

// CIELab with the Hunt adjustment: colours of dark pixels differ less to the eye, so a and b are scaled by L / 100.
inline Triple HuntLabFromLinear(const Triple& rgb_linear) {
  constexpr float kDelta = 6.0F / 29.0F;
  Triple f = RelativeXyz(rgb_linear);
  for (float& t : f) t = t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0F * kDelta * kDelta) + 4.0F / 29.0F;
  const float l = 116.0F * f[1] - 16.0F;
  const float hunt = 0.01F * l;
  return {l, hunt * 500.0F * (f[0] - f[1]), hunt * 200.0F * (f[1] - f[2])};
}

// HyAB, a distance for large differences of colour: city block between lightness and chroma, Euclidean within chroma.
inline float HyAb(const Triple& p, const Triple& q) {
  return std::abs(p[0] - q[0]) + std::hypot(p[1] - q[1], p[2] - q[2]);
}

}  // namespace skyquilt::metrics
