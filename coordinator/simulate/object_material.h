// How trees and cars look.
#pragma once

#include "coordinator/simulate/car.h"
#include "coordinator/simulate/surface.h"
#include "coordinator/simulate/tree.h"

namespace skyquilt::simulate {

Surface TreeSurface(const Tree& tree, const Hit& hit);
Surface CarSurface(const Car& car, const Hit& hit);

}  // namespace skyquilt::simulate
