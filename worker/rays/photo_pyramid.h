// Which sizes of the photos training rays are drawn from: at 1, 1/2, 1/4 and 1/8, each pixel the mean of a square of the photo's pixels in linear
// light. Without the smaller sizes the networks never learn what a place looks like from farther away.
#pragma once

#include <array>
#include <vector>

#include "core/base/random.h"

namespace skyquilt::worker {

constexpr int kPyramidLevels = 4;

class PhotoPyramid {
 public:
  // All rays at full size.
  PhotoPyramid() = default;
  // shares: of the rays at 1, 1/2, 1/4, 1/8; missing ones are 0; a sum of 1 is not required. first: shares at the start of the training (empty: as
  // `shares`), which change linearly into `shares` until the part `until` of the budget. progress: of the budget, 0 to 1.
  PhotoPyramid(const std::vector<double>& shares, const std::vector<double>& first, double until, double progress);

  // Draws a level: a pixel is 1 << level photo pixels wide. Uses no random number when all rays are at one size.
  int Draw(base::Random& random) const;

 private:
  std::array<double, kPyramidLevels> upper_ = {1.0, 1.0, 1.0, 1.0};  // sums of the shares
};

// The finest and the coarsest level that these options ever draw; both 0 for empty lists.
struct PyramidRange {
  int finest = 0, coarsest = 0;
};
PyramidRange RangeOf(const std::vector<double>& shares, const std::vector<double>& first);

}  // namespace skyquilt::worker
