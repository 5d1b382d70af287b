// A raster of heights without a place, for steps on working cells.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace skyquilt::surface {

inline constexpr float kNoHeight = std::numeric_limits<float>::quiet_NaN();

// value: [row][column]; NaN: none.
struct FloatGrid {
  int columns = 0, rows = 0;
  std::vector<float> value;

  FloatGrid() = default;
  FloatGrid(int n_columns, int n_rows, float fill = kNoHeight)
      : columns(n_columns), rows(n_rows), value(static_cast<size_t>(n_columns) * static_cast<size_t>(n_rows), fill) {}
  size_t Index(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column); }
  float At(int column, int row) const { return value[Index(column, row)]; }
};

}  // namespace skyquilt::surface
