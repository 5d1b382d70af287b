// How buildings look: plaster with windows, tiles, gravel roofs.
#pragma once

#include "simulate/building.h"
#include "simulate/surface.h"

namespace skyquilt::simulate {

// axis: building.Axis(), which costs too much to find again for every ray.
Surface BuildingSurface(const Building& building, const Eigen::Vector2f& axis, const Hit& hit);

}  // namespace skyquilt::simulate
