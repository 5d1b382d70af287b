// The step from pictures of depth to the finished mesh of level 0: pieces are fused within the memory limit, simplified tile by tile, joined and
// cleaned.
#pragma once

#include <vector>

#include "surface/mesh.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/surface_input.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

struct FusedMesh {
  double voxel_m = 0.0;  // larger than asked for where a piece, or the whole mesh, would not fit in memory
  double tile_size_m = 0.0;
  std::vector<MeshTile> tiles;  // level 0, sorted; empty: no surface was seen
  EdgeCounts edges;
  double area_m2 = 0.0;
  double filled_m2 = 0.0;
  double fusing_s = 0.0;  // seconds in which pieces were fused here or read, which other ranks could have done
};

// Side of a tile in voxels.
inline constexpr int kTileVoxels = 256;
// Of the work folder, for files of coarse meshes.
inline constexpr const char* kCoarseFolder = "coarse";

// Finished pieces are kept in input.work_folder and not computed again. The result does not depend on the memory limit as long as the voxel stays the
// same; how much larger it gets where the whole mesh does not fit depends on the pieces, which are smaller for several ranks. Throws base::UsageError
// when even three times larger voxels (eight times for the whole mesh) need too much memory, or when the boundary leaves nothing of the surface.
FusedMesh FuseMesh(const SurfaceInput& input, const DepthViews& views, double voxel_m, base::ThreadPool& threads);

// Bytes that a mesh takes.
double MeshBytes(const Mesh& mesh);

// Cuts the mesh of a piece along the lattice: each triangle belongs to the tile of the lattice edge that it crosses, whatever the piece. Only for
// meshes straight from FusePiece.
std::vector<MeshTile> SplitAlongLattice(const Mesh& mesh, int tile_voxels);

}  // namespace skyquilt::surface
