// Removes small pits from a raster of heights: holes in the mesh's floor, reflections in water, fog below the ground.
#pragma once

#include <cstdint>

#include "core/base/grid.h"

namespace skyquilt::surface {

// Sets the cells of pits to NaN and returns their number. A pit is a connected area of less than 25 m^2, more than 1 m (and three times the noise)
// lower than what surrounds it, and surrounded by ground: at least three quarters of the cells around it have a height, and nine tenths of these lie
// within smooth_m (and three times the noise) of one plane. So an alley between houses, whose ends are low, and ground seen through the crown of a
// tree, which is rough, are kept. Limits: pits beside larger gaps are kept, as are those wider than 5 m; a light well in a flat roof is taken for a
// pit, which does no harm where the ground is known elsewhere.
int64_t RemoveLowOutliers(base::Grid<float>* grid, double cell_m, double smooth_m);

// Standard deviation of the heights of single cells against their neighbours, robustly, in metres; 0 without neighbours.
double NoiseOf(const base::Grid<float>& grid);

}  // namespace skyquilt::surface
