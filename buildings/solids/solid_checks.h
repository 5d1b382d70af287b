// The parts of CheckSolid.
#pragma once

#include <utility>
#include <vector>

#include "buildings/solids/build_solids.h"

namespace skyquilt::buildings {

// Rings and planes, face by face: codes 1xx and 2xx. A wrong face is named once for each kind of damage.
std::vector<SolidProblem> CheckFaces(const Solid& solid, const SolidTriangles& triangles);
// How faces hang together: codes 301 to 305, 307, 309 and 405. For solids whose faces are right.
std::vector<SolidProblem> CheckShell(const Solid& solid, const SolidTriangles& triangles);
// Pairs of faces that have more in common than vertices and edges of both; each pair once.
std::vector<std::pair<uint32_t, uint32_t>> CrossingFaces(const Solid& solid, const SolidTriangles& triangles);

}  // namespace skyquilt::buildings
