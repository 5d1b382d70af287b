// From distances at nodes to triangles.
#pragma once

#include "core/base/thread_pool.h"
#include "surface/fusion/bricks.h"
#include "surface/fusion/integrate.h"
#include "surface/mesh.h"

namespace skyquilt::surface {

// Nodes on each side of a piece on which its mesh depends: cells around its edges, and the choices of the cells next to these.
constexpr int kHaloNodes = 2;

// The quads whose lattice edge has its lowest node in the piece, as in FusePiece. A quad is kept when its four cells have eight known corners each,
// and one end of its edge was seen by enough views and one by enough photos. The bricks must hold all known nodes of the piece and of its halo.
Mesh ExtractMesh(const Bricks& bricks, const NodeField& field, const LatticeBox& piece, const FuseOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::surface
