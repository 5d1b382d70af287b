// Which rank holds which blocks of a scene while it is rendered. A scene that does not fit into one rank's memory is divided among several ranks.
#pragma once

#include <span>
#include <vector>

#include "core/scene/field_store.h"

namespace skyquilt::coordinator {

// A group of ranks that together hold the whole scene, so the group can render any ray.
struct RenderGroup {
  std::vector<int> ranks;
  std::vector<int> owner;  // per block: index into `ranks`
};

// Divides the blocks among n >= 1 owners, in parts of about equal bytes. Blocks of one part are near each other on the ground: they are taken in
// Z-order (Morton 1966) of their centres. Returns each block's owner, 0..n-1; with more owners than blocks some own none.
std::vector<int> AssignBlocks(const scene::FieldStore& store, int n);

// For each block, the blocks with a lower index that overlap it within the blend margins.
std::vector<std::vector<int>> OverlappingLowerBlocks(const scene::FieldStore& store);

// Largest memory that any of the n owners needs, in bytes: its blocks, the blocks they are blended with, and the context.
double MaxBytesPerRank(const scene::FieldStore& store, const std::vector<std::vector<int>>& lower_neighbours, std::span<const int> owner, int n);

// As many groups as possible such that each rank's blocks fit its memory; one group of all ranks when even that is not enough (blocks are then
// loaded on demand). memory_bytes[i] belongs to ranks[i]; both have the same length, at least 1.
std::vector<RenderGroup> MakeRenderGroups(const scene::FieldStore& store, std::span<const int> ranks, std::span<const double> memory_bytes);

// The owner that renders an interval of a ray in which these blocks are blended: the owner of the first. `otherwise` without blocks.
inline int OwnerOf(std::span<const int> owner, std::span<const int> blocks, int otherwise) {
  return blocks.empty() ? otherwise : owner[static_cast<size_t>(blocks.front())];
}

}  // namespace skyquilt::coordinator
