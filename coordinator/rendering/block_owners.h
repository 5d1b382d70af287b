// Which rank holds which blocks of a scene while it is rendered.
#pragma once

#include <span>
#include <vector>

#include "core/scene/field_store.h"

namespace skyquilt::coordinator {

// Ranks that hold a scene together; every group can answer any ray. Numbers within a group from 0.
struct SceneHolders {
  std::vector<int> ranks;
  std::vector<int> owner;  // per block: number within the group
};

// Blocks dealt out to n owners in parts of about equal bytes that hang together on the ground (along a Z-order curve of their centres). Per block
// its owner; with more owners than blocks some get none.
std::vector<int> DealBlocks(const scene::FieldStore& store, int n);

// Per block the ones of lower number that it is blended with somewhere.
std::vector<std::vector<int>> LowerNeighbours(const scene::FieldStore& store);

// Bytes that the owner with most of them needs at once, the context and the neighbours included that its blocks are blended with.
double LargestPartBytes(const scene::FieldStore& store, const std::vector<std::vector<int>>& lower_neighbours, std::span<const int> owner, int n);

// As many groups as there can be such that everybody's share fits its memory; one group of all when not even that is enough.
// memory_bytes[i] belongs to ranks[i]; both have the same length, at least 1.
std::vector<SceneHolders> MakeGroups(const scene::FieldStore& store, std::span<const int> ranks, std::span<const double> memory_bytes);

// Who renders where these blocks meet; `otherwise` where there are none.
inline int OwnerOf(std::span<const int> owner, std::span<const int> blocks, int otherwise) {
  return blocks.empty() ? otherwise : owner[static_cast<size_t>(blocks.front())];
}

}  // namespace skyquilt::coordinator
