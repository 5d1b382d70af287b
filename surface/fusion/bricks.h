// The lattice is stored in bricks of 8 x 8 x 8 nodes, only where a picture of depth has a surface. Whether a brick is stored depends on the pictures
// alone, never on the piece that is fused.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "surface/fusion/fuse.h"
#include "surface/fusion/view_camera.h"

namespace skyquilt::surface {

constexpr int kBrickSide = 8;
constexpr int kBrickNodes = kBrickSide * kBrickSide * kBrickSide;

// Brick b holds the nodes from 8 b to 8 b + 7; shifts round down for negative nodes too.
inline int BrickOfNode(int node) {
  return node >> 3;
}

// Keys sort bricks by z, then y, then x. For coordinates within +-2^20.
inline uint64_t BrickKey(int x, int y, int z) {
  constexpr int kOffset = 1 << 20;
  return static_cast<uint64_t>(z + kOffset) << 42U | static_cast<uint64_t>(y + kOffset) << 21U | static_cast<uint64_t>(x + kOffset);
}

inline Eigen::Vector3i BrickOfKey(uint64_t key) {
  constexpr uint64_t kMask = (uint64_t{1} << 21U) - 1;
  const auto coordinate = [](uint64_t bits) { return static_cast<int>(bits) - (1 << 20); };
  return {coordinate(key & kMask), coordinate(key >> 21U & kMask), coordinate(key >> 42U)};
}

// Place of a node among those of its brick, from the lowest bits of its index.
inline size_t NodeInBrick(int x, int y, int z) {
  return static_cast<size_t>((x & 7) + kBrickSide * ((y & 7) + kBrickSide * (z & 7)));
}

// The stored bricks, sorted by key.
struct Bricks {
  std::vector<uint64_t> key;

  size_t size() const { return key.size(); }
  // -1: not stored.
  int64_t Find(const Eigen::Vector3i& brick) const {
    const uint64_t wanted = BrickKey(brick.x(), brick.y(), brick.z());
    const auto found = std::lower_bound(key.begin(), key.end(), wanted);
    return found != key.end() && *found == wanted ? found - key.begin() : -1;
  }
};

inline bool IsEmptyBox(const LatticeBox& box) {
  return box.min.x() >= box.max.x() || box.min.y() >= box.max.y() || box.min.z() >= box.max.z();
}

// The bricks that hold the nodes of a box that is not empty: a box of bricks.
LatticeBox BricksOfNodes(const LatticeBox& nodes);

// Where the surface in these bricks can be seen by a picture, in metres.
MetricBox ReachOfBricks(const LatticeBox& bricks, double voxel_m);

// Keys, sorted, of the bricks inside `range` that hold the nodes next to one view's surface: along each pixel's ray from one truncation before its
// depth to one behind it.
std::vector<uint64_t> MarkBricks(const ViewCamera& view, const LatticeBox& range, const FuseOptions& options);

// The bricks inside `range` that any view marks. Throws base::Interrupted.
Bricks MarkAllBricks(std::span<const ViewCamera> views, const LatticeBox& range, const FuseOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::surface
