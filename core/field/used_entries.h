// Finds the entries of a hash grid that rendering can read, so that a scene file need not store the others: entries at the corners of lattice cells
// that overlap occupied cells. Rendering gives the same bits without the others, which were used only early in training or never.
#pragma once

#include <cstdint>
#include <vector>

#include "core/encoding/hash_grid.h"
#include "core/field/occupancy_grid.h"

namespace skyquilt::field {

// One bit per entry (`features` floats of the flat parameter buffer), the first in the lowest bit of the first byte. Of the occupancy grid only size,
// cell and occupied are used.
std::vector<uint8_t> UsedEntries(const encoding::HashGrid& grid, const OccupancyGrid& occupancy);

}  // namespace skyquilt::field
