// Operations on whole meshes, and their edges with the triangles that use them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "surface/mesh.h"

namespace skyquilt::surface {

// One mesh of pieces that share vertices: those with the same key become one, with the larger number of views, filled only if all are. Triangles that
// have no three different vertices, or come twice, are dropped. Vertices are sorted by key and triangles by vertices, so the result does not depend
// on the order of the pieces.
Mesh MergeMeshes(std::vector<Mesh> pieces);
// These triangles of a mesh with the vertices that they use, in the order of the mesh, in no more memory than that takes.
Mesh Compacted(const Mesh& mesh, std::vector<Triangle> triangles);
// Removes vertices that no triangle uses; keeps the order of the others.
void DropUnusedVertices(Mesh* mesh);
// Removes connected pieces with a smaller area, square metres. Returns how many pieces were removed.
int DropIslands(Mesh* mesh, double min_area_m2);
// Set in the keys of vertices that close holes: a bit between sheet and cell, which VertexKey never sets.
inline constexpr uint64_t kFilledKeyBit = uint64_t{1} << 5U;
// The first free one of these keys; 2 * kFilledKeyBit leads from one to the next.
uint64_t NextFilledKey(const Mesh& mesh);

// Closes holes in the ground: open borders of at most 2000 edges that
//   - run around free space as seen from above, with an area there of at most max_area_m2, and do not cross or touch themselves or another border;
//   - are roughly level: highest minus lowest vertex at most 0.5 sqrt(area) + 0.5 m;
//   - belong to triangles that mostly (70 % of the border's length) point up, with a normal whose z is above 0.5;
//   - have nothing of the mesh inside as seen from above, whatever its height, but what is more than 3 m below the lowest vertex.
// The new surface is a membrane over the border in steps of about spacing_m (0 or less: as few triangles as possible). Each of its triangles has at
// least one new vertex, with filled = 1, views = 0 and a key with kFilledKeyBit, which no lattice vertex has. The mesh stays manifold. Returns the
// area that was closed, square metres.
double FillGroundHoles(Mesh* mesh, double max_area_m2, double spacing_m);
// Whether photos see something farther through this place of a surface, whose normal is given (ENU, length 1).
using IsOpenThere = std::function<bool(const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal_enu)>;
// Closes holes in walls, roofs and ceilings, in the same way and marked as those in the ground: open borders of at most 2000 edges that
//   - are nowhere further than off_plane_m from a plane (that of the least squares), and run around free space in it, with an area of at most
//     max_area_m2, and do not cross or touch themselves or another border;
//   - belong to triangles that mostly (70 % of the border's length) lie in it, with a normal within 60 degrees of the plane's;
//   - have nothing of the mesh inside, within 2 off_plane_m of the plane;
//   - are none that FillGroundHoles would close, or leaves open because of what lies above or below;
//   - are not open at any new vertex, as is_open tells (null: nothing is).
double FillPlanarHoles(Mesh* mesh, double max_area_m2, double spacing_m, double off_plane_m, const IsOpenThere& is_open);

struct EdgeCounts {
  int64_t edges = 0;
  int64_t boundary = 0;      // of one triangle
  int64_t non_manifold = 0;  // of three or more, or of two with opposite orientation
};
EdgeCounts CountEdges(const Mesh& mesh);
double Area(const Mesh& mesh);  // square metres

// A triangle that has the edge between the vertices low < high.
struct EdgeUse {
  uint32_t low = 0, high = 0;
  uint32_t triangle = 0;
  bool upwards = false;  // the triangle runs from low to high
};

// All edges of all triangles, sorted by (low, high, triangle), so that the uses of an edge are neighbours. Edges of a triangle that has a vertex
// twice are left out when they join the vertex to itself.
std::vector<EdgeUse> SortedEdgeUses(const Mesh& mesh);
// The uses of the edge that begins at uses[begin]; begin must be less than the number of uses.
std::span<const EdgeUse> UsesOfEdge(const std::vector<EdgeUse>& uses, size_t begin);
// Whether the mesh has this edge, in any direction.
bool HasEdge(const std::vector<EdgeUse>& uses, uint32_t a, uint32_t b);

}  // namespace skyquilt::surface
