// Appearance of trees and cars.
#pragma once

#include "simulate/car.h"
#include "simulate/surface.h"
#include "simulate/tree.h"

namespace skyquilt::simulate {

Surface TreeSurface(const Tree& tree, const Hit& hit);
Surface CarSurface(const Car& car, const Hit& hit);

}  // namespace skyquilt::simulate
