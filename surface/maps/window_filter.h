// Lowest and highest values in square windows, and what is made of them (grey-scale morphology). The time does not depend on the window: van Herk
// 1992, Gil and Werman 1993.
#pragma once

#include "core/base/grid.h"

namespace skyquilt::surface {

// The lowest (highest) value in the window of 2 * half + 1 cells around each cell. Windows are cut off at the grid's edge; NaN is left out. NaN where
// the window has no value.
base::Grid<float> WindowMinimum(const base::Grid<float>& grid, int half);
base::Grid<float> WindowMaximum(const base::Grid<float>& grid, int half);

// The highest of the minima of all windows that hold the cell: removes what is narrower than the window and rises above its surroundings. Only
// windows around cells with a value count, so that an object beside a gap is not hidden from the ground by windows that end in the gap. NaN stays
// NaN.
base::Grid<float> Opening(const base::Grid<float>& grid, int half);
// The same for what lies lower.
base::Grid<float> Closing(const base::Grid<float>& grid, int half);

}  // namespace skyquilt::surface
