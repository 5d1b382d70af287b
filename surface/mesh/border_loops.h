// The closed borders of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "surface/mesh/mesh_tools.h"

namespace skyquilt::surface {

struct BorderLoop {
  std::vector<uint32_t> vertex;    // in the direction of the triangles: the surface is on the left, seen from the free space
  std::vector<uint32_t> triangle;  // triangle[i] has the edge from vertex[i] to the next one
};

// All borders whose vertices have one incoming and one outgoing border edge each, in the order of their smallest vertices, which come first. Borders
// that touch themselves or each other at a vertex are left out: how to walk them is ambiguous.
std::vector<BorderLoop> SimpleBorderLoops(const Mesh& mesh, const std::vector<EdgeUse>& uses);

}  // namespace skyquilt::surface
