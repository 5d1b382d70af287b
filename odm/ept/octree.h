// Divides points into the nodes of an octree, each of which thins what lies deeper: a viewer that loads the upper nodes sees the whole cloud,
// coarsely. Every point is in one node. A node takes the first point in each cell of a grid of kSpan^3 cells; others go to its eight children.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <unordered_set>
#include <vector>

#include "odm/ept/ept_points.h"

namespace skyquilt::odm::ept {

constexpr int kSpan = 128;
constexpr int kSpanLog2 = 7;
// A node that would have no more points takes all of them.
constexpr size_t kLeafPoints = 20'000;

// Receives each node once, when it is complete; not empty.
using NodeSink = std::function<void(const NodeKey& key, std::span<const Point> points)>;

// The node and all below it, of these points, which all lie in its cube. `points` is used up.
void BuildSubtree(const Cube& cube, const NodeKey& key, std::vector<Point> points, const NodeSink& sink);

// The upper nodes of a tree whose lower parts are built one by one (BuildSubtree), because all points at once would not fit into memory.
class UpperNodes {
 public:
  // Nodes of less than this depth, >= 1.
  UpperNodes(const Cube& cube, int depth) : cube_(cube), depth_(depth) {}
  // Whether one of them takes the point; it belongs below otherwise.
  bool Take(const Point& point);
  void Finish(const NodeSink& sink);

 private:
  struct Node {
    std::unordered_set<uint32_t> taken;  // cells
    std::vector<Point> points;
  };
  Cube cube_;
  int depth_;
  std::map<NodeKey, Node> nodes_;
};

}  // namespace skyquilt::odm::ept
