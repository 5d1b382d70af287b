// Which entries of a hash grid rendering can read: those at the corners of lattice cells that occupied cells touch. The others are what training
// passed through on its way, or never came to; without them a field looks the same to the bit.
#pragma once

#include <cstdint>
#include <vector>

#include "core/encoding/hash_grid.h"
#include "core/field/occupancy_grid.h"

namespace skyquilt::field {

// One bit per `features` numbers of the flat parameter buffer, the first in the lowest bit of the first byte. Only size, cell and occupied of the
// occupancy are read.
std::vector<uint8_t> ReachedEntries(const encoding::HashGrid& grid, const OccupancyGrid& occupancy);

}  // namespace skyquilt::field
