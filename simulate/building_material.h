// Appearance of buildings: plaster with windows, tiled and gravel roofs.
#pragma once

#include "simulate/simulated_building.h"
#include "simulate/surface.h"

namespace skyquilt::simulate {

// axis: building.Axis(), passed in because computing it for every ray is slow.
Surface BuildingSurface(const Building& building, const Eigen::Vector2f& axis, const Hit& hit);

}  // namespace skyquilt::simulate
