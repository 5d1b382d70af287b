#include <algorithm>
#include <limits>
#include <tuple>

#include "core/base/errors.h"
#include "surface/mesh/mesh_tools.h"

namespace skyquilt::surface {
namespace {

struct KeyedVertex {
  uint64_t key = 0;
  uint32_t piece = 0, vertex = 0;
};

// An order of vertices that does not depend on the piece they come from.
auto OrderOf(const Mesh& mesh, uint32_t v) {
  const Eigen::Vector3d& x = mesh.position[v];
  return std::tuple(x.x(), x.y(), x.z());
}

Triangle SmallestFirst(const Triangle& t) {
  if (t[1] < t[0] && t[1] < t[2]) return {t[1], t[2], t[0]};
  if (t[2] < t[0] && t[2] < t[1]) return {t[2], t[0], t[1]};
  return t;
}

}  // namespace

Mesh MergeMeshes(std::vector<Mesh> pieces) {
  Mesh merged;
  std::vector<KeyedVertex> vertices;
  size_t n_vertices = 0, n_triangles = 0;
  for (const Mesh& piece : pieces) {
    n_vertices += piece.key.size();
    n_triangles += piece.triangle.size();
  }
  SKYQUILT_CHECK(n_vertices < std::numeric_limits<uint32_t>::max(), std::to_string(n_vertices) + " vertices do not fit in 32-bit indices");
  vertices.reserve(n_vertices);
  std::vector<std::vector<uint32_t>> index_of(pieces.size());
  for (size_t i = 0; i < pieces.size(); ++i) {
    index_of[i].resize(pieces[i].key.size());
    for (size_t v = 0; v < pieces[i].key.size(); ++v) vertices.push_back({pieces[i].key[v], static_cast<uint32_t>(i), static_cast<uint32_t>(v)});
  }
  std::sort(vertices.begin(), vertices.end(),
            [](const KeyedVertex& a, const KeyedVertex& b) { return std::tie(a.key, a.piece, a.vertex) < std::tie(b.key, b.piece, b.vertex); });
  for (size_t i = 0; i < vertices.size();) {
    const uint64_t key = vertices[i].key;
    const KeyedVertex* chosen = &vertices[i];
    uint8_t views = 0, filled = 1;
    for (; i < vertices.size() && vertices[i].key == key; ++i) {
      const Mesh& piece = pieces[vertices[i].piece];
      if (OrderOf(piece, vertices[i].vertex) < OrderOf(pieces[chosen->piece], chosen->vertex)) chosen = &vertices[i];
      views = std::max(views, piece.views[vertices[i].vertex]);
      filled = std::min(filled, piece.filled[vertices[i].vertex]);
      index_of[vertices[i].piece][vertices[i].vertex] = static_cast<uint32_t>(merged.key.size());
    }
    merged.position.push_back(pieces[chosen->piece].position[chosen->vertex]);
    merged.key.push_back(key);
    merged.views.push_back(views);
    merged.filled.push_back(filled);
  }
  merged.triangle.reserve(n_triangles);
  for (size_t i = 0; i < pieces.size(); ++i) {
    for (const Triangle& t : pieces[i].triangle) {
      const Triangle own = {index_of[i][t[0]], index_of[i][t[1]], index_of[i][t[2]]};
      if (own[0] != own[1] && own[1] != own[2] && own[2] != own[0]) merged.triangle.push_back(SmallestFirst(own));
    }
    pieces[i] = Mesh();  // its memory is needed no longer
  }
  std::sort(merged.triangle.begin(), merged.triangle.end());
  merged.triangle.erase(std::unique(merged.triangle.begin(), merged.triangle.end()), merged.triangle.end());
  return merged;
}

void DropUnusedVertices(Mesh* mesh) {
  std::vector<uint8_t> used(mesh->position.size(), 0);
  for (const Triangle& t : mesh->triangle) {
    for (const uint32_t v : t) used[v] = 1;
  }
  std::vector<uint32_t> index_of(mesh->position.size(), 0);
  uint32_t n = 0;
  for (size_t v = 0; v < used.size(); ++v) {
    if (used[v] == 0) continue;
    mesh->position[n] = mesh->position[v];
    mesh->key[n] = mesh->key[v];
    mesh->views[n] = mesh->views[v];
    mesh->filled[n] = mesh->filled[v];
    index_of[v] = n++;
  }
  mesh->position.resize(n);
  mesh->key.resize(n);
  mesh->views.resize(n);
  mesh->filled.resize(n);
  for (Triangle& t : mesh->triangle) {
    for (uint32_t& v : t) v = index_of[v];
  }
}

}  // namespace skyquilt::surface
