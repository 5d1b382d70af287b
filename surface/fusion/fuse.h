// From pictures of depth to a mesh, piece by piece: distances to the surface are averaged on the lattice (truncated signed distance function, Curless
// and Levoy 1996), and the surface where they change sign is meshed (dual marching, one vertex per sheet and cell).
// Lengths are in metres in survey ENU, boxes in indices of the lattice (fusion_lattice.h).
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/base/errors.h"
#include "core/base/thread_pool.h"
#include "surface/fusion/fusion_lattice.h"
#include "surface/mesh.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// A piece does not fit into the memory limit.
struct TooLittleMemory : base::UsageError {
  using UsageError::UsageError;
};

struct FuseOptions {
  double voxel_m = 0.0;
  double truncation_voxels = 4.0;
  int min_views = 3;            // views, virtual ones included, that must have seen a face
  int min_photos = 1;           // of them photos
  int tile_voxels = 256;        // borders between pieces are at multiples of it
  bool coarse = false;          // large triangles: pieces are not simplified, and end before a boundary
  double max_angle_deg = 85.0;  // a surface seen at a larger angle from its normal counts as seen at this angle
};

// For pieces that several processes fuse: as many of them, and as small, where there are enough tiles.
struct PieceWishes {
  size_t least_pieces = 1;
  double memory_bytes = std::numeric_limits<double>::infinity();
};

// Pieces whose columns cover all surface in `whole`, none without surface, each small enough to be fused in `memory_bytes`. Only their x and y
// extents differ; they do not overlap, and do not reach out of `whole`. needs_bytes: takes the memory that the largest needs. Throws
// TooLittleMemory when a single tile needs more memory, naming how much, and when `whole` has more voxels than VertexKey can tell apart;
// base::Interrupted.
std::vector<LatticeBox> PlanPieces(std::span<const DepthView> views, const LatticeBox& whole, const FuseOptions& options, double memory_bytes,
                                   base::ThreadPool& threads, const PieceWishes& wishes = {}, double* needs_bytes = nullptr);

// The least memory, in bytes, with which PlanPieces can plan; 0 when there is no surface. For choosing larger voxels before giving up.
double LargestTileBytes(std::span<const DepthView> views, const LatticeBox& whole, const FuseOptions& options, base::ThreadPool& threads);

// The mesh of one piece: the quads whose lattice edge has its lowest node in the piece, cut in two triangles. Vertices at its borders have the same
// positions, bit by bit, and the same keys as in the piece next to it: every node is fused from the same views in the same order. No edge has more
// than two triangles; in the union of pieces the triangles around a vertex are one fan. Same bits for any number of threads.
// Empty when no view sees it. Throws base::Interrupted.
Mesh FusePiece(std::span<const DepthView> views, const LatticeBox& piece, const FuseOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::surface
