#include <algorithm>
#include <numeric>

#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

// Sets of connected vertices; each set is named by its smallest vertex.
class ConnectedVertices {
 public:
  explicit ConnectedVertices(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  uint32_t SetOf(uint32_t v) {
    while (parent_[v] != v) {
      parent_[v] = parent_[parent_[v]];
      v = parent_[v];
    }
    return v;
  }
  void Join(uint32_t a, uint32_t b) {
    const uint32_t x = SetOf(a), y = SetOf(b);
    parent_[std::max(x, y)] = std::min(x, y);
  }

 private:
  std::vector<uint32_t> parent_;
};

}  // namespace

int DropIslands(Mesh* mesh, double min_area_m2) {
  ConnectedVertices sets(mesh->position.size());
  for (const Triangle& t : mesh->triangle) {
    sets.Join(t[0], t[1]);
    sets.Join(t[0], t[2]);
  }
  std::vector<double> area(mesh->position.size(), 0.0);  // of the set that is named by this vertex
  std::vector<uint8_t> has_triangles(mesh->position.size(), 0);
  for (const Triangle& t : mesh->triangle) {
    const uint32_t set = sets.SetOf(t[0]);
    area[set] += 0.5 * DoubleAreaNormal(mesh->position[t[0]], mesh->position[t[1]], mesh->position[t[2]]).norm();
    has_triangles[set] = 1;
  }
  int dropped = 0;
  // Written so that pieces without a usable area are dropped too.
  const auto is_island = [&](uint32_t set) { return !(area[set] >= min_area_m2); };
  for (size_t v = 0; v < area.size(); ++v) {
    if (has_triangles[v] != 0 && is_island(static_cast<uint32_t>(v))) ++dropped;
  }
  std::erase_if(mesh->triangle, [&](const Triangle& t) { return is_island(sets.SetOf(t[0])); });
  DropUnusedVertices(mesh);
  return dropped;
}

}  // namespace skyquilt::surface
