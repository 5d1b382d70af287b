// Regular lattices over a box with edges `extent`, for the encodings that have tables.
#pragma once

#include <functional>

#include "core/kernel/kernels.h"

namespace skyquilt::encoding {

// A dense lattice with `resolution` cells per unit length, at least one cell per axis. The caller sets `entries`.
kernel::GridLevel DenseLattice(const double extent[3], double resolution);
// Number of lattice points of a level; may exceed 32 bits.
double LatticePoints(const kernel::GridLevel& level);
// The largest resolution in [1, finest] with count(resolution) <= budget, for a count that never decreases; 1 when there is none.
double FinestResolutionWithinBudget(double budget, double finest, const std::function<double(double)>& count);

}  // namespace skyquilt::encoding
