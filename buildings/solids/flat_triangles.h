// Triangles of a polygon with holes in the plane, without new points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace skyquilt::buildings {

// Rings of indices into `place`: the first counter-clockwise, holes clockwise; they may touch at points and go straight on. Triangles are
// counter-clockwise, use every point and are constrained Delaunay, hence the least narrow ones. Empty when rounding leaves no way.
std::vector<std::array<uint32_t, 3>> FlatTriangles(std::span<const Eigen::Vector2d> place, std::span<const std::vector<uint32_t>> rings);

}  // namespace skyquilt::buildings
