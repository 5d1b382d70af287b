// Peak signal-to-noise ratio, the usual measure of how well a rendering matches a photo; in dB with MAX = 1, higher is better.
//   a, b   equal shapes, any number of channels, display values in [0,1] (not clamped here)
//   mask   one channel of the images' size, 0: ignore; null: every pixel counts
// All channels of a pixel have the same weight. Sums are in double, so the order of rows changes the result by less than 1e-12.
// Edges: nothing scored gives NaN; identical images give +infinity; a NaN in a scored pixel gives NaN.
// Wrong shapes throw std::logic_error.
#pragma once

#include <cstdint>

#include "core/image/image.h"

namespace skyquilt::metrics {

struct SquaredError {
  double sum = 0.0;
  int64_t n_values = 0;  // scored pixels times channels

  // Adds the errors of other pixels.
  SquaredError& operator+=(const SquaredError& other) {
    sum += other.sum;
    n_values += other.n_values;
    return *this;
  }
};

SquaredError SumSquaredError(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask);
// 10 log10(1 / mean squared error).
double PsnrOf(const SquaredError& error);
double Psnr(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask);

}  // namespace skyquilt::metrics
