// Edges of a solid with the faces that they join.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

// Length 1, out of the solid; zero for a face without area.
Eigen::Vector3d NormalOf(const Solid& solid, const Face& face);

struct SolidEdge {
  uint32_t from = 0, to = 0;  // vertices, in the direction in which `face` runs along it
  int face = 0;               // into Solid::face
  int other = -1;             // the face that runs back; -1: the solid is open here
  double angle_rad = 0.0;     // between the normals of both; pi when there is no other face
  bool convex = true;         // the solid is inside the angle, as at a ridge; not at a valley
};
// Each edge once, in the order of the faces. Edges of more than two faces come once for each pair.
std::vector<SolidEdge> EdgesOf(const Solid& solid);

}  // namespace skyquilt::buildings
