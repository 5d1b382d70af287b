// Fills the gaps of a raster of heights with the smoothest surface through their edges.
#pragma once

#include "core/base/grid.h"

namespace skyquilt::surface {

// Cells without a value get the solution of Laplace's equation with the values around them (no flow through the grid's edge), after a plane through
// all values was taken off, so that slopes go on through gaps and to the grid's edge. Solved from coarse to fine grids (cascadic multigrid, Bornemann
// and Deuflhard 1996) to a few per cent of the relief of the gap's edge. Values stay as they are. A grid without any value stays empty.
void FillSmoothly(base::Grid<float>* grid);

}  // namespace skyquilt::surface
