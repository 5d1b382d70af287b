// Gable wings whose ridge runs into the roof of a neighbour.
#pragma once

#include "buildings/building.h"

namespace skyquilt::buildings {

// Sets Part::joins of each gable that ends at a side of a pitched part whose roof falls towards it, lies between that side's ends, and has a ridge
// above the eave and not above the ridge of that part (up to 0.3 m more are lowered to it).
void JoinWings(Shape* shape);

}  // namespace skyquilt::buildings
