#include "core/metrics/depth_errors.h"

#include <cmath>
#include <limits>

#include "core/base/order_statistics.h"
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
  errors.median_abs_m = base::Median({absolute_m_.begin(), absolute_m_.end()});
  return errors;
}

void DepthErrorCollector::Save(base::BytePacker* out) const {
  out->Add(absolute_m_);
  out->Add(sum_of_squares_);
  out->Add(n_missing_);
}

void DepthErrorCollector::Load(base::ByteUnpacker* in) {
  in->Take(&absolute_m_);
  in->Take(&sum_of_squares_);
  in->Take(&n_missing_);
}

DepthErrors CompareDepth(const image::ImageF& rendered, const image::ImageF& truth, const image::Image8* mask) {
  DepthErrorCollector collector;
  collector.Add(rendered, truth, mask);
  return collector.Result();
}

}  // namespace skyquilt::metrics
