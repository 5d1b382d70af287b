// Vertices that a solid does not need.
#pragma once

#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

// Takes out vertices where two faces have a straight edge, and those of no face.
void RemoveStraightVertices(Solid* solid);

}  // namespace skyquilt::buildings
