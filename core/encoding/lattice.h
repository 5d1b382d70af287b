// Regular lattices over a box with edges `extent`, shared by the encodings that have tables.
#pragma once

#include <functional>

#include "core/kernel/kernels.h"

namespace skyquilt::encoding {

// `resolution` cells per unit length, at least one cell per axis; the level is marked dense, its entries are left to the caller.
kernel::HashLevel DenseLattice(const double extent[3], double resolution);
// Lattice points of a level; more than 32 bits hold for fine ones.
double LatticePoints(const kernel::HashLevel& level);
// The largest resolution in [1, finest] whose count(resolution), which never falls, is at most `budget`; 1 when none is.
double FittingResolution(double budget, double finest, const std::function<double(double)>& count);

}  // namespace skyquilt::encoding
