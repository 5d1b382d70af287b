#include "buildings/solids/straight_vertices.h"

#include <algorithm>
#include <utility>

namespace skyquilt::buildings {
namespace {

constexpr double kOffLine = 0.002;  // metres that rounding to millimetres may move a vertex off a line

template <typename Visit>
void ForEachRing(Solid* solid, const Visit& visit) {
  for (Face& face : solid->face) {
    visit(&face.outer);
    for (std::vector<uint32_t>& hole : face.holes) visit(&hole);
  }
}

bool IsBetween(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d ab = b - a;
  const double along = (point - a).dot(ab) / ab.squaredNorm();
  return along > 0.0 && along < 1.0 && (point - a - along * ab).norm() <= kOffLine;
}

// Whether one was taken out.
bool RemoveOnce(Solid* solid) {
  struct Use {
    std::vector<uint32_t>* ring;
    uint32_t before, after;
  };
  std::vector<std::vector<Use>> uses(solid->vertex.size());
  ForEachRing(solid, [&](std::vector<uint32_t>* ring) {
    const size_t n = ring->size();
    for (size_t i = 0; i < n; ++i) uses[(*ring)[i]].push_back({ring, (*ring)[(i + n - 1) % n], (*ring)[(i + 1) % n]});
  });
  for (uint32_t v = 0; v < uses.size(); ++v) {
    if (uses[v].size() != 2) continue;
    const Use &one = uses[v][0], &two = uses[v][1];
    if (one.before != two.after || one.after != two.before || one.before == one.after) continue;
    if (one.ring->size() <= 3 || two.ring->size() <= 3 || one.ring == two.ring) continue;
    if (!IsBetween(solid->vertex[v], solid->vertex[one.before], solid->vertex[one.after])) continue;
    std::erase(*one.ring, v);
    std::erase(*two.ring, v);
    return true;
  }
  return false;
}

void RemoveUnused(Solid* solid) {
  std::vector<bool> used(solid->vertex.size(), false);
  ForEachRing(solid, [&](const std::vector<uint32_t>* ring) {
    for (const uint32_t v : *ring) used[v] = true;
  });
  std::vector<uint32_t> number(solid->vertex.size(), 0);
  std::vector<Eigen::Vector3d> kept;
  for (size_t v = 0; v < used.size(); ++v) {
    number[v] = static_cast<uint32_t>(kept.size());
    if (used[v]) kept.push_back(solid->vertex[v]);
  }
  solid->vertex = std::move(kept);
  ForEachRing(solid, [&](std::vector<uint32_t>* ring) {
    for (uint32_t& v : *ring) v = number[v];
  });
}

}  // namespace

void RemoveStraightVertices(Solid* solid) {
  while (RemoveOnce(solid)) {
  }
  RemoveUnused(solid);
}

}  // namespace skyquilt::buildings
