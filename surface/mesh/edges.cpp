#include <algorithm>
#include <utility>

#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {

std::vector<EdgeUse> SortedEdgeUses(const Mesh& mesh) {
  const auto for_each_use = [&mesh](const auto& visit) {
    for (size_t t = 0; t < mesh.triangle.size(); ++t) {
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t from = mesh.triangle[t][k], to = mesh.triangle[t][(k + 1) % 3];
        if (from != to) visit(EdgeUse{std::min(from, to), std::max(from, to), static_cast<uint32_t>(t), from < to});
      }
    }
  };
  // First into one bucket per lower vertex, which leaves little to sort.
  std::vector<size_t> end(mesh.position.size() + 1, 0);
  for_each_use([&](const EdgeUse& use) { ++end[use.low + 1]; });
  for (size_t v = 1; v < end.size(); ++v) end[v] += end[v - 1];
  std::vector<EdgeUse> uses(end.back());
  std::vector<size_t> next(end.begin(), end.end() - 1);
  for_each_use([&](const EdgeUse& use) { uses[next[use.low]++] = use; });
  for (size_t v = 0; v + 1 < end.size(); ++v) {
    std::sort(uses.begin() + static_cast<std::ptrdiff_t>(end[v]), uses.begin() + static_cast<std::ptrdiff_t>(end[v + 1]),
              [](const EdgeUse& a, const EdgeUse& b) { return std::pair(a.high, a.triangle) < std::pair(b.high, b.triangle); });
  }
  return uses;
}

std::span<const EdgeUse> UsesOfEdge(const std::vector<EdgeUse>& uses, size_t begin) {
  size_t end = begin;
  while (end < uses.size() && uses[end].low == uses[begin].low && uses[end].high == uses[begin].high) ++end;
  return {uses.data() + begin, end - begin};
}

bool HasEdge(const std::vector<EdgeUse>& uses, uint32_t a, uint32_t b) {
  const std::pair wanted(std::min(a, b), std::max(a, b));
  const auto found = std::lower_bound(uses.begin(), uses.end(), wanted, [](const EdgeUse& use, const std::pair<uint32_t, uint32_t>& edge) {
    return std::pair(use.low, use.high) < edge;
  });
  return found != uses.end() && found->low == wanted.first && found->high == wanted.second;
}

EdgeCounts CountEdges(const Mesh& mesh) {
  EdgeCounts counts;
  const std::vector<EdgeUse> uses = SortedEdgeUses(mesh);
  for (size_t i = 0; i < uses.size();) {
    const std::span<const EdgeUse> edge = UsesOfEdge(uses, i);
    ++counts.edges;
    if (edge.size() == 1) {
      ++counts.boundary;
    } else if (edge.size() > 2 || edge[0].upwards == edge[1].upwards) {
      ++counts.non_manifold;
    }
    i += edge.size();
  }
  return counts;
}

double Area(const Mesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangle) {
    area += 0.5 * DoubleAreaNormal(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]).norm();
  }
  return area;
}

}  // namespace skyquilt::surface
