// Gable wings whose ridge runs into the roof of a neighbour.
#pragma once

#include "buildings/building.h"

namespace skyquilt::buildings {

// The part into whose roof the ridge of a gable may run, or -1: one with a pitched roof that falls towards the gable's end, whose side reaches past
// both of the gable's, and with an eave below the gable's ridge and a ridge not below it, but for 0.3 m of noise. Of several, the highest.
int MayJoin(const Shape& shape, const Part& wing);

}  // namespace skyquilt::buildings
