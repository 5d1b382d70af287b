// Smooth weights that blend the fields of neighbouring blocks and sum to one.
#pragma once

#include <vector>

#include "partition/block.h"

namespace skyquilt::partition {

// Product over x and y of ramps that rise from 0 at `margin_m` outside the core box to 1 at `margin_m` inside it, as smoothstep
// s(u) = u^2 (3 - 2u). Because s(u) + s(1 - u) = 1, the ramps of neighbours with equal margins add up to one across their common edge;
// at the rim of the area the weight fades to 0. A margin of 0 gives a step that owns its lower edges. In [0, 1]; NaN positions give 0.
double BlockWeight(const Block& block, double x, double y);

// The weights of all blocks at a place, empty blocks 0, divided by their sum: they add up to one wherever any block reaches, and are all 0
// elsewhere. One entry per block.
std::vector<double> BlockWeights(const BlockSet& blocks, double x, double y);

}  // namespace skyquilt::partition
