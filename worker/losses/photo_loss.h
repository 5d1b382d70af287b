// Compares one colour channel of a rendered ray with its pixel, both as display values: squared error, either directly or after the tone curve that
// spreads dark and bright values (core/brightness/tone_curve.h), for badly exposed photos.
#pragma once

#include "core/brightness/tone_curve.h"

namespace skyquilt::worker {

// Weight of the photo loss of a pixel of a photo reduced to 1, 1/2, 1/4, 1/8 (level 0 to 3). The mean of many pixels has smaller errors than one
// pixel, which would otherwise be learned last. (Barron et al. 2021, Mip-NeRF, weigh by area: 1, 4, 16, 64.)
constexpr float kPhotoLossWeight[] = {1.0F, 1.5F, 2.25F, 3.375F};

// A saturated pixel is a lower bound of the light, a black pixel an upper bound: true when the rendering satisfies the bound. target: pixel, 0..1;
// residual: rendering minus pixel.
template <typename T>
bool SatisfiesClippedBound(T target, T residual) {
  return (target >= T(254.5F / 255.0F) && residual > T(0)) || (target <= T(0.5F / 255.0F) && residual < T(0));
}

template <typename T>
struct PhotoLoss {
  double value = 0.0;
  T gradient = T(0);           // by the rendered display value
  double squared_error = 0.0;  // of display values, for any loss
  bool counts = false;         // false: the bound of a saturated or black pixel is satisfied; value and gradient are zero
};

// rendered: any finite display value; target: pixel, 0..1.
template <typename T>
PhotoLoss<T> SquaredPhotoLoss(T rendered, T target) {
  const T residual = rendered - target;
  const double squared = static_cast<double>(residual) * static_cast<double>(residual);
  if (SatisfiesClippedBound(target, residual)) return {0.0, T(0), squared, false};
  return {squared, T(2) * residual, squared, true};
}

template <typename T>
PhotoLoss<T> TonedPhotoLoss(T rendered, T target) {
  const T error = rendered - target;
  const double squared_error = static_cast<double>(error) * static_cast<double>(error);
  const auto [toned, slope] = brightness::ToneCurve(rendered);
  const T residual = toned - brightness::ToneCurve(target).value;
  if (SatisfiesClippedBound(target, residual)) return {0.0, T(0), squared_error, false};
  return {static_cast<double>(residual) * static_cast<double>(residual), T(2) * residual * slope, squared_error, true};
}

}  // namespace skyquilt::worker
