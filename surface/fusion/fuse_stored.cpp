// The functions of fuse.h for pictures of depth that are kept in a file.
#include "surface/fusion/fuse.h"

namespace skyquilt::surface {
namespace {

std::vector<DepthView> AllViews(const DepthViews& views) {
  std::vector<DepthView> all;
  all.reserve(views.size());
  for (size_t view = 0; view < views.size(); ++view) all.push_back(views[view]);
  return all;
}

}  // namespace

std::vector<LatticeBox> PlanPieces(const DepthViews& views, const LatticeBox& whole, const FuseOptions& options, double memory_bytes,
                                   base::ThreadPool& threads) {
  return PlanPieces(std::span<const DepthView>(AllViews(views)), whole, options, memory_bytes, threads);
}

double LargestTileBytes(const DepthViews& views, const LatticeBox& whole, const FuseOptions& options, base::ThreadPool& threads) {
  return LargestTileBytes(std::span<const DepthView>(AllViews(views)), whole, options, threads);
}

Mesh FusePiece(const DepthViews& views, const LatticeBox& piece, const FuseOptions& options, base::ThreadPool& threads) {
  return FusePiece(std::span<const DepthView>(AllViews(views)), piece, options, threads);
}

}  // namespace skyquilt::surface
