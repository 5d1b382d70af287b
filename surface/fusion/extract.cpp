#include "surface/fusion/extract.h"

#include <limits>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "surface/fusion/brick_surface.h"

namespace skyquilt::surface {
namespace {

// The surfaces of all bricks, and where the vertices of each begin in the joint mesh.
struct JointSurface {
  std::vector<BrickSurface> bricks;
  std::vector<size_t> first_vertex;
};

// The bricks before and at a brick along each axis; -1: not stored.
std::array<int64_t, 8> LowerNeighbours(const Bricks& bricks, const Eigen::Vector3i& brick) {
  std::array<int64_t, 8> neighbours{};
  for (int i = 0; i < 8; ++i) neighbours[static_cast<size_t>(i)] = bricks.Find(brick - Eigen::Vector3i(i & 1, i >> 1 & 1, i >> 2 & 1));
  return neighbours;
}

// The vertices around a quad's edge, counter-clockwise seen from its upper end.
std::array<uint32_t, 4> VerticesAround(const JointSurface& surface, const std::array<int64_t, 8>& neighbours, const QuadEdge& quad) {
  const int node[3] = {quad.node % kBrickSide, quad.node / kBrickSide % kBrickSide, quad.node / (kBrickSide * kBrickSide)};
  const int b = (quad.axis + 1) % 3;
  const int c = (quad.axis + 2) % 3;
  constexpr int kBack[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
  std::array<uint32_t, 4> vertices{};
  for (size_t i = 0; i < 4; ++i) {
    int cell[3] = {node[0], node[1], node[2]};
    cell[b] -= kBack[i][0];
    cell[c] -= kBack[i][1];
    const int before = (cell[0] < 0 ? 1 : 0) | (cell[1] < 0 ? 2 : 0) | (cell[2] < 0 ? 4 : 0);
    const int64_t brick = neighbours[static_cast<size_t>(before)];
    SKYQUILT_CHECK(brick >= 0, "a quad of the surface reaches into a brick that is not stored");
    const int edge = 4 * quad.axis + kBack[i][0] + 2 * kBack[i][1];
    const auto in_brick = static_cast<uint16_t>(NodeInBrick(cell[0], cell[1], cell[2]));
    const auto at = static_cast<size_t>(brick);
    vertices[i] = static_cast<uint32_t>(surface.first_vertex[at] + surface.bricks[at].VertexOf(in_brick, edge));
  }
  return vertices;
}

// Cuts quads along their shorter diagonal, which is the same in every piece because positions are.
std::vector<Triangle> TrianglesOfBrick(const JointSurface& surface, const std::vector<Eigen::Vector3d>& position, const Bricks& bricks,
                                       size_t brick) {
  std::vector<Triangle> triangles;
  if (surface.bricks[brick].quads.empty()) return triangles;
  triangles.reserve(2 * surface.bricks[brick].quads.size());
  const std::array<int64_t, 8> neighbours = LowerNeighbours(bricks, BrickOfKey(bricks.key[brick]));
  for (const QuadEdge& quad : surface.bricks[brick].quads) {
    const std::array<uint32_t, 4> v = VerticesAround(surface, neighbours, quad);
    const double diagonal_02 = (position[v[0]] - position[v[2]]).squaredNorm();
    const double diagonal_13 = (position[v[1]] - position[v[3]]).squaredNorm();
    Triangle first = diagonal_02 <= diagonal_13 ? Triangle{v[0], v[1], v[2]} : Triangle{v[0], v[1], v[3]};
    Triangle second = diagonal_02 <= diagonal_13 ? Triangle{v[0], v[2], v[3]} : Triangle{v[1], v[2], v[3]};
    // Seen from the upper end they turn counter-clockwise; when that is the inside, turn them over.
    if (!quad.inside_is_lower) {
      std::swap(first[1], first[2]);
      std::swap(second[1], second[2]);
    }
    triangles.push_back(first);
    triangles.push_back(second);
  }
  return triangles;
}

// Joins the vertices of all bricks and frees them there.
void JoinVertices(JointSurface* surface, Mesh* mesh) {
  size_t n_vertices = 0;
  for (const BrickSurface& brick : surface->bricks) {
    surface->first_vertex.push_back(n_vertices);
    n_vertices += brick.key.size();
  }
  SKYQUILT_CHECK(n_vertices < std::numeric_limits<uint32_t>::max(), "a piece of the surface has more vertices than a triangle can name");
  mesh->position.reserve(n_vertices);
  mesh->key.reserve(n_vertices);
  mesh->views.reserve(n_vertices);
  for (BrickSurface& brick : surface->bricks) {
    mesh->position.insert(mesh->position.end(), brick.position.begin(), brick.position.end());
    mesh->key.insert(mesh->key.end(), brick.key.begin(), brick.key.end());
    mesh->views.insert(mesh->views.end(), brick.views.begin(), brick.views.end());
    brick.position = {};
    brick.key = {};
    brick.views = {};
  }
}

// Removes the vertices that only quads of neighbouring pieces use.
void DropVerticesOfNeighbours(Mesh* mesh) {
  constexpr uint32_t kUnused = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> new_index(mesh->position.size(), kUnused);
  for (const Triangle& triangle : mesh->triangle) {
    for (const uint32_t v : triangle) new_index[v] = 0;
  }
  uint32_t n_used = 0;
  for (size_t v = 0; v < new_index.size(); ++v) {
    if (new_index[v] == kUnused) continue;
    mesh->position[n_used] = mesh->position[v];
    mesh->key[n_used] = mesh->key[v];
    mesh->views[n_used] = mesh->views[v];
    new_index[v] = n_used++;
  }
  mesh->position.resize(n_used);
  mesh->key.resize(n_used);
  mesh->views.resize(n_used);
  mesh->filled.assign(n_used, 0);
  for (Triangle& triangle : mesh->triangle) {
    for (uint32_t& v : triangle) v = new_index[v];
  }
}

}  // namespace

Mesh ExtractMesh(const Bricks& bricks, const NodeField& field, const LatticeBox& piece, const FuseOptions& options, base::ThreadPool& threads) {
  constexpr size_t kPerTask = 16;
  const auto in_groups = [&](const auto& of_brick) {
    const size_t n_tasks = (bricks.size() + kPerTask - 1) / kPerTask;
    threads.ParallelFor(static_cast<int64_t>(n_tasks), [&](int64_t task, int) {
      base::ThrowIfCancelled();
      const size_t begin = static_cast<size_t>(task) * kPerTask;
      for (size_t brick = begin; brick < std::min(begin + kPerTask, bricks.size()); ++brick) of_brick(brick);
    });
  };
  JointSurface surface;
  surface.bricks.resize(bricks.size());
  in_groups([&](size_t brick) { surface.bricks[brick] = SurfaceOfBrick(bricks, field, brick, piece, options); });
  Mesh mesh;
  JoinVertices(&surface, &mesh);
  std::vector<std::vector<Triangle>> triangles(bricks.size());
  in_groups([&](size_t brick) { triangles[brick] = TrianglesOfBrick(surface, mesh.position, bricks, brick); });
  size_t n_triangles = 0;
  for (const std::vector<Triangle>& of_brick : triangles) n_triangles += of_brick.size();
  mesh.triangle.reserve(n_triangles);
  for (std::vector<Triangle>& of_brick : triangles) {
    mesh.triangle.insert(mesh.triangle.end(), of_brick.begin(), of_brick.end());
    of_brick = {};
  }
  DropVerticesOfNeighbours(&mesh);
  return mesh;
}

}  // namespace skyquilt::surface
