// How buildings look: plaster with windows, tiles, gravel roofs.
#pragma once

#include "coordinator/simulate/building.h"
#include "coordinator/simulate/surface.h"

namespace skyquilt::simulate {

Surface BuildingSurface(const Building& building, const Hit& hit);

}  // namespace skyquilt::simulate
