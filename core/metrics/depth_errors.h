// How far rendered surfaces are from the true ones: errors of rendered depth against true depth, both in metres along the same rays.
//   rendered, truth   one channel, equal sizes; NaN or infinity: no depth
//   mask              one channel, 0: ignore; null: every pixel counts
// A pixel is scored when both depths are finite and the mask does not ignore it. When nothing is scored, errors are NaN and n = 0. Different sizes
// throw std::logic_error.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/packed_bytes.h"
#include "core/image/image.h"

namespace skyquilt::metrics {

struct DepthErrors {
  double rmse_m = 0.0;
  double median_abs_m = 0.0;
  int64_t n = 0;          // scored pixels
  int64_t n_missing = 0;  // pixels that the mask does not ignore, with true but without rendered depth
};

// Errors over several photos: the median is over the pixels of all of them. Needs four bytes of memory per scored pixel.
class DepthErrorCollector {
 public:
  void Add(const image::ImageF& rendered, const image::ImageF& truth, const image::Image8* mask);
  DepthErrors Result() const;
  // All that was added, so that another collector can go on from here.
  void Save(base::BytePacker* out) const;
  void Load(base::ByteUnpacker* in);

 private:
  std::vector<float> absolute_m_;
  double sum_of_squares_ = 0.0;
  int64_t n_missing_ = 0;
};

// Errors of one photo.
DepthErrors CompareDepth(const image::ImageF& rendered, const image::ImageF& truth, const image::Image8* mask);

}  // namespace skyquilt::metrics
