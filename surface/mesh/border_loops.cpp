#include "surface/mesh/border_loops.h"

#include <limits>

namespace skyquilt::surface {

std::vector<BorderLoop> SimpleBorderLoops(const Mesh& mesh, const std::vector<EdgeUse>& uses) {
  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max(), kSeveral = kNone - 1;
  struct Way {
    uint32_t next = kNone, previous = kNone, triangle = kNone;
  };
  std::vector<Way> ways(mesh.position.size());
  for (size_t i = 0; i < uses.size();) {
    const size_t n = UsesOfEdge(uses, i).size();
    if (n == 1) {
      const EdgeUse& use = uses[i];
      const uint32_t from = use.upwards ? use.low : use.high, to = use.upwards ? use.high : use.low;
      ways[from].next = ways[from].next == kNone ? to : kSeveral;
      ways[from].triangle = use.triangle;
      ways[to].previous = ways[to].previous == kNone ? from : kSeveral;
    }
    i += n;
  }
  std::vector<BorderLoop> loops;
  std::vector<uint8_t> visited(ways.size(), 0);
  for (uint32_t start = 0; start < ways.size(); ++start) {
    if (visited[start] != 0 || ways[start].next == kNone) continue;
    BorderLoop loop;
    uint32_t v = start;
    while (v < kSeveral && visited[v] == 0 && ways[v].next != kSeveral && ways[v].previous != kSeveral) {
      visited[v] = 1;
      loop.vertex.push_back(v);
      loop.triangle.push_back(ways[v].triangle);
      v = ways[v].next;
    }
    if (v == start && !loop.vertex.empty()) loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace skyquilt::surface
