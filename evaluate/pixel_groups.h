// Which block a surface point belongs to, whether it lies in a seam, and squared errors of a group of pixels.
// Boxes are looked at from above; frame: survey ENU, metres.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "core/geo/block_box.h"
#include "core/metrics/psnr.h"

namespace skyquilt::evaluate {

enum class Zone : uint8_t {
  kOutside,   // in no block
  kInterior,  // deeper than the margin inside a block
  kSeam,      // where the grown boxes of two or more blocks overlap
  kRim,       // near an edge of a block that no other block touches
};

// The block whose core box [min, max) holds the point; -1 when none does.
int BlockAt(const Eigen::Vector3d& x_in_enu, std::span<const geo::BlockBox> boxes);
// Zone of a point in core box `block` (as BlockAt returned it).
Zone ZoneAt(const Eigen::Vector3d& x_in_enu, int block, std::span<const geo::BlockBox> boxes);

// Adds one pixel's RGB difference, display values in [0,1].
void AddPixel(const float* a, const float* b, metrics::SquaredError* error);
inline int64_t PixelsOf(const metrics::SquaredError& error) {
  return error.n_values / 3;
}

}  // namespace skyquilt::evaluate
