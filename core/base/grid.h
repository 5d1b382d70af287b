// Values in the cells of a grid, row by row. Where the cells lie is said elsewhere: geo/plane_grid.h for ENU and other planes, gis/map_grid.h for
// maps.
#pragma once

#include <cstddef>
#include <vector>

namespace skyquilt::base {

struct GridShape {
  int columns = 0, rows = 0;

  size_t size() const { return static_cast<size_t>(columns) * static_cast<size_t>(rows); }
  bool Inside(int column, int row) const { return column >= 0 && row >= 0 && column < columns && row < rows; }
  size_t Index(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column); }
};

template <typename T>
struct Grid : GridShape {
  std::vector<T> value;  // [row][column]

  Grid() = default;
  explicit Grid(const GridShape& shape, T fill = T{}) : GridShape(shape), value(shape.size(), fill) {}
  Grid(int n_columns, int n_rows, T fill = T{}) : Grid(GridShape{n_columns, n_rows}, fill) {}
  T At(int column, int row) const { return value[Index(column, row)]; }
};

}  // namespace skyquilt::base
