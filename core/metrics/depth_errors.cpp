#include "core/metrics/depth_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/metrics/check_shapes.h"

namespace skyquilt::metrics {

void DepthErrorCollector::Add(const image::ImageF& rendered, const image::ImageF& truth, const image::Image8* mask) {
  CheckShapes(rendered, truth, mask);
  SKYQUILT_CHECK(truth.channels == 1, "depth has one channel, not " + std::to_string(truth.channels));
  for (size_t i = 0; i < truth.data.size(); ++i) {
    if (!std::isfinite(truth.data[i]) || (mask != nullptr && mask->data[i] == 0)) continue;
    if (!std::isfinite(rendered.data[i])) {
      ++n_missing_;
      continue;
    }
    const double error_m = static_cast<double>(rendered.data[i]) - static_cast<double>(truth.data[i]);
    absolute_m_.push_back(static_cast<float>(std::abs(error_m)));
    sum_of_squares_ += error_m * error_m;
  }
}

DepthErrors DepthErrorCollector::Result() const {
  DepthErrors errors;
  errors.n = static_cast<int64_t>(absolute_m_.size());
  errors.n_missing = n_missing_;
  if (absolute_m_.empty()) {
    errors.rmse_m = errors.median_abs_m = std::numeric_limits<double>::quiet_NaN();
    return errors;
  }
  errors.rmse_m = std::sqrt(sum_of_squares_ / static_cast<double>(errors.n));
  std::vector<float> sorted = absolute_m_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  errors.median_abs_m = static_cast<double>(*middle);
  if (sorted.size() % 2 == 0) errors.median_abs_m = 0.5 * (errors.median_abs_m + static_cast<double>(*std::max_element(sorted.begin(), middle)));
  return errors;
}

DepthErrors CompareDepth(const image::ImageF& rendered, const image::ImageF& truth, const image::Image8* mask) {
  DepthErrorCollector collector;
  collector.Add(rendered, truth, mask);
  return collector.Result();
}

}  // namespace skyquilt::metrics
