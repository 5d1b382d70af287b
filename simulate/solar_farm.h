// A solar farm: rows of identical tables of panels on nearly level ground. Each place looks like hundreds of others, so that features match in wrong
// pairs that agree with each other: the hardest photos to find poses for.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "simulate/surface.h"
#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

inline constexpr float kTableLength_m = 24.0F;  // along a row, which runs from west to east
inline constexpr float kTablePitch_m = 25.0F;   // from one table of a row to the next
inline constexpr float kRowPitch_m = 6.5F;      // from one row to the next

// Adds tables that fill a rectangle (ENU metres), tilted to the south on posts. `ground`: ENU height of the ground at a place (east, north).
void AddSolarTables(const Eigen::Vector2d& min, const Eigen::Vector2d& max, const std::function<float(float east, float north)>& ground, Mesh& mesh);

// Dark cells in thin bright frames, the same on every table; sheet metal below.
Surface SolarTableSurface(const Hit& hit);
// Short grass with patches of bare soil, the same everywhere.
Surface FarmGround(const Hit& hit, uint32_t seed);

}  // namespace skyquilt::simulate
