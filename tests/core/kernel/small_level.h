// A small level of a hash grid, for tests.
#pragma once

#include "core/kernel/kernels.h"

namespace skyquilt::kernel {

inline GridLevel LevelOf(bool dense) {
  GridLevel level;
  level.cells_per_unit = 9.0F;
  level.size[0] = level.size[1] = 10;
  level.size[2] = 5;
  level.dense = dense;
  level.entries = dense ? 500 : 128;
  return level;
}

}  // namespace skyquilt::kernel
