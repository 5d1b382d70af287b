#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

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

void ReserveVertices(Mesh* mesh, size_t n) {
  mesh->position.reserve(n);
  mesh->key.reserve(n);
  mesh->views.reserve(n);
  mesh->filled.reserve(n);
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
  size_t n_keys = 0;
  for (size_t i = 0; i < vertices.size(); ++i) n_keys += i == 0 || vertices[i].key != vertices[i - 1].key ? 1 : 0;
  ReserveVertices(&merged, n_keys);
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
  // Their memory is needed no longer.
  vertices = {};
  for (Mesh& piece : pieces) {
    piece.position = {};
    piece.key = {};
    piece.views = {};
    piece.filled = {};
  }
  merged.triangle.reserve(n_triangles);
  for (size_t i = 0; i < pieces.size(); ++i) {
    for (const Triangle& t : pieces[i].triangle) {
      const Triangle own = {index_of[i][t[0]], index_of[i][t[1]], index_of[i][t[2]]};
      if (own[0] != own[1] && own[1] != own[2] && own[2] != own[0]) merged.triangle.push_back(SmallestFirst(own));
    }
    pieces[i].triangle = {};
    index_of[i] = {};
  }
  std::sort(merged.triangle.begin(), merged.triangle.end());
  merged.triangle.erase(std::unique(merged.triangle.begin(), merged.triangle.end()), merged.triangle.end());
  return merged;
}

Mesh Compacted(const Mesh& mesh, std::vector<Triangle> triangles) {
  constexpr uint32_t kUnused = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> index_of(mesh.position.size(), kUnused);
  for (const Triangle& t : triangles) {
    for (const uint32_t v : t) index_of[v] = 0;
  }
  const auto n_used = static_cast<size_t>(std::count_if(index_of.begin(), index_of.end(), [](uint32_t index) { return index != kUnused; }));
  Mesh compact;
  ReserveVertices(&compact, n_used);
  for (size_t v = 0; v < index_of.size(); ++v) {
    if (index_of[v] == kUnused) continue;
    index_of[v] = static_cast<uint32_t>(compact.position.size());
    compact.position.push_back(mesh.position[v]);
    compact.key.push_back(mesh.key[v]);
    compact.views.push_back(mesh.views[v]);
    compact.filled.push_back(mesh.filled[v]);
  }
  for (Triangle& t : triangles) {
    for (uint32_t& v : t) v = index_of[v];
  }
  compact.triangle = std::move(triangles);
  return compact;
}

void DropUnusedVertices(Mesh* mesh) {
  std::vector<Triangle> triangles = std::move(mesh->triangle);
  *mesh = Compacted(*mesh, std::move(triangles));
}

}  // namespace skyquilt::surface
