#include "odm/ept/octree.h"

#include <algorithm>
#include <utility>

namespace skyquilt::odm::ept {
namespace {

// Deepest node whose grid still has cells of at least one whole number.
int DeepestLevel(const Cube& cube) {
  return std::max(0, cube.Levels() - kSpanLog2);
}

// Cell of the grid of the node of this depth in which the point lies.
uint32_t GridCell(const Cube& cube, const Point& point, int depth) {
  // Where the cube is smaller than the grid, cells are single whole numbers.
  const int levels = std::min(depth + kSpanLog2, cube.Levels());
  const std::array<int32_t, 3> fine = cube.CellOf(point, levels);
  uint32_t cell = 0;
  for (const int32_t value : fine) cell = cell * kSpan + static_cast<uint32_t>(value % kSpan);
  return cell;
}

}  // namespace

void BuildSubtree(const Cube& cube, const NodeKey& key, std::vector<Point> points, const NodeSink& sink) {
  if (points.empty()) return;
  if (points.size() <= kLeafPoints || key.depth >= DeepestLevel(cube)) {
    sink(key, points);
    return;
  }
  std::array<std::vector<Point>, 8> below;
  {
    std::vector<Point> own;
    std::unordered_set<uint32_t> taken;
    for (const Point& point : points) {
      if (taken.insert(GridCell(cube, point, key.depth)).second) {
        own.push_back(point);
        continue;
      }
      const std::array<int32_t, 3> cell = cube.CellOf(point, key.depth + 1);
      below[static_cast<size_t>((cell[0] & 1) * 4 + (cell[1] & 1) * 2 + (cell[2] & 1))].push_back(point);
    }
    points = {};
    sink(key, own);
  }
  for (int child = 0; child < 8; ++child) {
    const NodeKey deeper{key.depth + 1, {2 * key.cell[0] + (child >> 2), 2 * key.cell[1] + ((child >> 1) & 1), 2 * key.cell[2] + (child & 1)}};
    BuildSubtree(cube, deeper, std::move(below[static_cast<size_t>(child)]), sink);
  }
}

bool UpperNodes::Take(const Point& point) {
  for (int depth = 0; depth < depth_; ++depth) {
    Node& node = nodes_[{depth, cube_.CellOf(point, depth)}];
    if (!node.taken.insert(GridCell(cube_, point, depth)).second) continue;
    node.points.push_back(point);
    return true;
  }
  return false;
}

void UpperNodes::Finish(const NodeSink& sink) {
  for (const auto& [key, node] : nodes_) sink(key, node.points);
  nodes_.clear();
}

}  // namespace skyquilt::odm::ept
