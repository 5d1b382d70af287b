#include "core/metrics/psnr.h"

#include <cmath>
#include <limits>

#include "core/metrics/check_shapes.h"

namespace skyquilt::metrics {

SquaredError SumSquaredError(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask) {
  CheckShapes(a, b, mask);
  SquaredError error;
  const auto row_values = static_cast<size_t>(a.width) * static_cast<size_t>(a.channels);
  for (int y = 0; y < a.height; ++y) {
    const float* row_a = a.data.data() + static_cast<size_t>(y) * row_values;
    const float* row_b = b.data.data() + static_cast<size_t>(y) * row_values;
    double row_sum = 0.0;
    for (int x = 0; x < a.width; ++x) {
      if (mask != nullptr && *mask->At(x, y) == 0) continue;
      for (int c = 0; c < a.channels; ++c) {
        const auto at = static_cast<size_t>(x * a.channels + c);
        const double difference = static_cast<double>(row_a[at]) - static_cast<double>(row_b[at]);
        row_sum += difference * difference;
      }
      error.n_values += a.channels;
    }
    error.sum += row_sum;
  }
  return error;
}

double PsnrOf(const SquaredError& error) {
  if (error.n_values == 0) return std::numeric_limits<double>::quiet_NaN();
  return -10.0 * std::log10(error.sum / static_cast<double>(error.n_values));
}

double Psnr(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask) {
  return PsnrOf(SumSquaredError(a, b, mask));
}

}  // namespace skyquilt::metrics
