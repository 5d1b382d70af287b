// Distances to the surface, averaged over views at the nodes of the stored bricks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/fusion/bricks.h"

namespace skyquilt::surface {

// Arrays of kBrickNodes values per brick, in the order of the bricks and of NodeInBrick.
struct NodeField {
  std::vector<float> psi;       // mean signed distance over the truncation, -1 (inside) to 1 (free space); NaN: no view knows
  std::vector<uint8_t> views;   // views whose surface is within half a truncation, at most 255
  std::vector<uint8_t> photos;  // of them photos
};

// A view measures the distance to the tangent plane of the surface at the node's pixel. Its weight is cosine / distance^2, falls to 0 from one voxel
// to one truncation behind the surface, and is a tenth beside missing pixels and steps of depth. For each node the views are added in their order, so
// the result does not depend on the number of threads or the set of bricks. Throws base::Interrupted.
NodeField IntegrateViews(std::span<const ViewCamera> views, const Bricks& bricks, const FuseOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::surface
