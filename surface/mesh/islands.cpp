#include "core/base/disjoint_sets.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {

int DropIslands(Mesh* mesh, double min_area_m2) {
  base::DisjointSets sets(mesh->position.size());
  for (const Triangle& t : mesh->triangle) {
    sets.Join(t[0], t[1]);
    sets.Join(t[0], t[2]);
  }
  std::vector<double> area(mesh->position.size(), 0.0);  // of the connected vertices of which this one is the first
  std::vector<uint8_t> has_triangles(mesh->position.size(), 0);
  for (const Triangle& t : mesh->triangle) {
    const uint32_t set = sets.Root(t[0]);
    area[set] += 0.5 * DoubleAreaNormal(mesh->position[t[0]], mesh->position[t[1]], mesh->position[t[2]]).norm();
    has_triangles[set] = 1;
  }
  int dropped = 0;
  // Written so that pieces without a usable area are dropped too.
  const auto is_island = [&](uint32_t set) { return !(area[set] >= min_area_m2); };
  for (size_t v = 0; v < area.size(); ++v) {
    if (has_triangles[v] != 0 && is_island(static_cast<uint32_t>(v))) ++dropped;
  }
  std::erase_if(mesh->triangle, [&](const Triangle& t) { return is_island(sets.Root(t[0])); });
  DropUnusedVertices(mesh);
  return dropped;
}

}  // namespace skyquilt::surface
