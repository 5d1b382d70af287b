#include <gtest/gtest.h>

#include <algorithm>

#include "made_meshes.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/simplify.h"

namespace skyquilt::surface {
namespace {

std::vector<Mesh> Pieces(const Mesh& mesh, double size_m) {
  std::vector<Mesh> pieces;
  for (MeshTile& tile : SplitIntoTiles(mesh, size_m)) pieces.push_back(std::move(tile.mesh));
  return pieces;
}

void ExpectSame(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.key, b.key);
  EXPECT_EQ(a.views, b.views);
  EXPECT_EQ(a.filled, b.filled);
  EXPECT_EQ(a.triangle, b.triangle);
}

TEST(MergeMeshes, CutSurfaceIsClosedAgain) {
  const Mesh sphere = MergeMeshes({SphereMesh(8, 5.0)});
  EXPECT_EQ(sphere.position.size(), 6U * 64U + 2U);
  const EdgeCounts counts = CountEdges(sphere);
  EXPECT_EQ(counts.boundary, 0);
  EXPECT_EQ(counts.non_manifold, 0);
  EXPECT_EQ(counts.edges * 2, static_cast<int64_t>(sphere.triangle.size() * 3));
  std::vector<Mesh> pieces = Pieces(sphere, 2.5);
  EXPECT_GT(pieces.size(), 8U);
  ExpectSame(MergeMeshes(pieces), sphere);
  std::reverse(pieces.begin(), pieces.end());
  ExpectSame(MergeMeshes(pieces), sphere);
}

TEST(MergeMeshes, KeepsMostViewsAndDropsTrianglesThatComeTwice) {
  Mesh a = GridMesh(0, 0, 1, 1, Flat), b = a;
  b.views[0] = 9;
  b.filled[1] = 1;
  const Mesh merged = MergeMeshes({a, b});
  EXPECT_EQ(merged.triangle.size(), 2U);
  EXPECT_EQ(*std::max_element(merged.views.begin(), merged.views.end()), 9);
  EXPECT_EQ(*std::max_element(merged.filled.begin(), merged.filled.end()), 0);
}

TEST(MergeMeshes, OfNothingIsEmpty) {
  EXPECT_TRUE(MergeMeshes({}).position.empty());
  EXPECT_TRUE(MergeMeshes({Mesh(), Mesh()}).triangle.empty());
}

TEST(DropUnusedVertices, KeepsTheOrderOfTheOthers) {
  Mesh mesh = GridMesh(0, 0, 3, 1, Flat, [](int x, int) { return x == 2; });
  DropUnusedVertices(&mesh);
  ASSERT_EQ(mesh.position.size(), 4U);
  EXPECT_EQ(mesh.position[0], Eigen::Vector3d(2, 0, 0));
  EXPECT_EQ(mesh.position[3], Eigen::Vector3d(3, 1, 0));
  EXPECT_EQ(mesh.key.size(), 4U);
  EXPECT_DOUBLE_EQ(Area(mesh), 1.0);
}

TEST(DropIslands, RemovesSmallPiecesOnly) {
  // Pieces of 9, 4 and 1 square metres.
  Mesh mesh = GridMesh(0, 0, 12, 3, Flat, [](int x, int y) { return x < 3 || (x >= 5 && x < 7 && y < 2) || (x == 10 && y == 0); });
  EXPECT_EQ(DropIslands(&mesh, 4.0), 1);
  EXPECT_DOUBLE_EQ(Area(mesh), 13.0);
  EXPECT_EQ(DropIslands(&mesh, 4.001), 1);
  EXPECT_DOUBLE_EQ(Area(mesh), 9.0);
  EXPECT_EQ(mesh.position.size(), 16U);
  EXPECT_EQ(DropIslands(&mesh, 100.0), 1);
  EXPECT_TRUE(mesh.position.empty());
  EXPECT_EQ(DropIslands(&mesh, 1.0), 0);
}

TEST(DropIslands, PiecesWithoutAFiniteAreaGo) {
  Mesh mesh = GridMesh(
      0, 0, 5, 1, [](int x, int) { return x > 3 ? std::nan("") : 0.0; }, [](int x, int) { return x != 2; });
  EXPECT_EQ(DropIslands(&mesh, 0.0), 1);
  EXPECT_DOUBLE_EQ(Area(mesh), 2.0);
}

TEST(CountEdges, TellsBordersAndBadEdges) {
  Mesh mesh = GridMesh(0, 0, 1, 1, Flat);
  EXPECT_EQ(CountEdges(mesh).edges, 5);
  EXPECT_EQ(CountEdges(mesh).boundary, 4);
  EXPECT_EQ(CountEdges(mesh).non_manifold, 0);
  std::swap(mesh.triangle[1][0], mesh.triangle[1][1]);  // turned over
  EXPECT_EQ(CountEdges(mesh).non_manifold, 1);
  mesh.triangle.push_back({0, 1, 2});  // runs along 0-1 like the first one
  EXPECT_EQ(CountEdges(mesh).non_manifold, 2);
  mesh.triangle = {{0, 1, 3}, {3, 1, 0}, {1, 3, 2}};
  EXPECT_EQ(CountEdges(mesh).non_manifold, 1);  // three triangles at 1-3
  EXPECT_EQ(CountEdges(mesh).boundary, 2);
}

}  // namespace
}  // namespace skyquilt::surface
