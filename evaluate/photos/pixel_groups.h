// Groups pixels by where their surface point is: in which block, and whether inside it or in a seam between blocks.
// Only x and y of points and boxes count. Frame: survey ENU, metres.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "core/geo/block_box.h"
#include "core/metrics/psnr.h"

namespace skyquilt::evaluate::photos {

enum class Zone : uint8_t {
  kOutside,   // in no block
  kInterior,  // farther than the margin from the edges of its block
  kSeam,      // where the boxes of two or more blocks, with margins, overlap
  kRim,       // near an edge of a block without a neighbour
};

// Index of the block whose core box [min, max) contains the point; -1 when none does.
int BlockAt(const Eigen::Vector3d& x_in_enu, std::span<const geo::BlockBox> boxes);
// Zone of a point. block: result of BlockAt for it.
Zone ZoneAt(const Eigen::Vector3d& x_in_enu, int block, std::span<const geo::BlockBox> boxes);

// Adds one pixel's RGB difference, display values in [0,1].
void AddPixel(const float* a, const float* b, skyquilt::metrics::SquaredError* error);
inline int64_t PixelsOf(const skyquilt::metrics::SquaredError& error) {
  return error.n_values / 3;
}

}  // namespace skyquilt::evaluate::photos
