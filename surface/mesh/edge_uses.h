// The edges of a mesh with the triangles that use them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/mesh.h"

namespace skyquilt::surface {

// A triangle that has the edge between the vertices low < high.
struct EdgeUse {
  uint32_t low = 0, high = 0;
  uint32_t triangle = 0;
  bool upwards = false;  // the triangle runs from low to high
};

// All edges of all triangles, sorted by (low, high, triangle), so that the uses of an edge are neighbours. Edges of a triangle that has a vertex
// twice are left out when they join the vertex to itself.
std::vector<EdgeUse> SortedEdgeUses(const Mesh& mesh);
// The uses of the edge that begins at uses[begin]; begin must be less than the number of uses.
std::span<const EdgeUse> UsesOfEdge(const std::vector<EdgeUse>& uses, size_t begin);
// Whether the mesh has this edge, in any direction.
bool HasEdge(const std::vector<EdgeUse>& uses, uint32_t a, uint32_t b);

}  // namespace skyquilt::surface
