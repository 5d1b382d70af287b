// Fewer triangles for the same surface (quadric edge collapse, Garland and Heckbert 1997), and coarser levels of it.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "surface/mesh.h"

namespace skyquilt::surface {

// Simplified copy whose surface is at most about max_error_m away; 0 or less: nothing is simplified. Vertices are a subset, in the same order. Holds
// for any mesh:
//   - Vertices on open borders, and at places that are not manifold, stay, and no new edge joins two of them. So the copy has the same borders, and
//     neighbours that were simplified apart meet again as a manifold.
//   - It has no non-manifold edges that the mesh has not.
//   - Each triangle comes from one of the mesh, and their normals are at most 45 degrees apart: none turns over.
//   - A triangle with a filled vertex comes from one that has one too, and the other way round.
// New triangles are at least 1/50 as high as their longest edge is long, or no narrower than those they come from.
// About max_error_m: every removed vertex was that close to the triangles that took its place, and the planes of all removed triangles are that close
// to the vertex that stands for them, in the root mean square by area. Errors of single places can add up over many collapses to a few times as much.
// error_m: the largest root mean square reached (may be null).
Mesh Simplify(const Mesh& mesh, double max_error_m, double* error_m);

// Cuts a mesh into the tiles of level 0: each triangle belongs to the tile of its middle. Tiles are sorted by TileId, their vertices and triangles
// are in the order of the mesh. Triangles without a finite middle are left out.
std::vector<MeshTile> SplitIntoTiles(const Mesh& mesh, double tile_size_m);
// All levels of detail, finest first and sorted by TileId, without empty tiles. Each tile joins its children, simplified to max_error_m * 2^level
// with locked outer borders, so that tiles of one level meet without cracks. The last level is a single tile, or up to four tiles that meet at the
// origin: columns -1 and 0 (rows as well) are never joined, because halving leaves both as they are. Same bits for any number of threads.
// base::Interrupted when cancelled.
std::vector<MeshTile> BuildLevels(std::vector<MeshTile> finest, double max_error_m, base::ThreadPool& threads);

}  // namespace skyquilt::surface
