#include "surface/fusion/fuse.h"

#include "surface/fusion/extract.h"

namespace skyquilt::surface {

Mesh FusePiece(std::span<const DepthView> views, const LatticeBox& piece, const FuseOptions& options, base::ThreadPool& threads) {
  if (IsEmptyBox(piece)) return {};
  SKYQUILT_CHECK(options.voxel_m > 0.0 && options.truncation_voxels > 0.0, "voxels and truncation must be positive");
  SKYQUILT_CHECK(HasDistinctKeys(piece), "the piece is too large for the keys of its vertices");
  LatticeBox nodes = piece;
  nodes.min.array() -= kHaloNodes;
  nodes.max.array() += kHaloNodes;
  const LatticeBox range = BricksOfNodes(nodes);
  const std::vector<ViewCamera> cameras = CamerasThatSee(views, ReachOfBricks(range, options.voxel_m));
  const Bricks bricks = MarkAllBricks(cameras, range, options, threads);
  const NodeField field = IntegrateViews(cameras, bricks, options, threads);
  return ExtractMesh(bricks, field, piece, options, threads);
}

}  // namespace skyquilt::surface
