// The check of all kernels that read and write hash tables.
#pragma once

#include <algorithm>
#include <bit>
#include <string>

#include "core/base/errors.h"
#include "core/kernel/kernels.h"

namespace skyquilt::kernel {

// Every lattice point must have its entry, and every result its place.
inline void CheckHashShapes(const GridLevel& level, int features, const Positions& at, int64_t n, size_t stride) {
  SKYQUILT_CHECK(features == 2 || features == 4, std::to_string(features) + " features per entry");
  SKYQUILT_CHECK(n >= 0 && stride >= static_cast<size_t>(n), "stride " + std::to_string(stride) + ", " + std::to_string(n) + " samples");
  SKYQUILT_CHECK(at.points == 1 || (at.points > 1 && at.plane >= static_cast<size_t>(n)),
                 std::to_string(at.points) + " positions per sample, " + std::to_string(at.plane) + " apart");
  SKYQUILT_CHECK(std::min({level.size[0], level.size[1], level.size[2]}) >= 2, "an axis of fewer than two points");
  const int64_t points = int64_t{level.size[0]} * level.size[1] * level.size[2];
  SKYQUILT_CHECK(level.dense ? points <= int64_t{level.entries} : std::has_single_bit(level.entries),
                 std::to_string(level.entries) + " entries for " + std::to_string(points) + " points");
}

}  // namespace skyquilt::kernel
