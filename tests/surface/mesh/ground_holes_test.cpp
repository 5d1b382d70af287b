#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <set>

#include "made_meshes.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

bool HasFilled(const Mesh& mesh, const Triangle& t) {
  return mesh.filled[t[0]] + mesh.filled[t[1]] + mesh.filled[t[2]] > 0;
}

double FilledArea(const Mesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangle) {
    if (HasFilled(mesh, t)) area += 0.5 * DoubleAreaNormal(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]).norm();
  }
  return area;
}

// Ground of 20 m x 20 m with a hole of 4 m x 4 m.
bool IsAroundHole(int x, int y) {
  return x < 8 || x >= 12 || y < 8 || y >= 12;
}
Mesh GroundWithHole(const HeightOf& height = Flat) {
  Mesh mesh = GridMesh(0, 0, 20, 20, height, IsAroundHole);
  DropUnusedVertices(&mesh);
  return mesh;
}

// Other vertices have the same place and key.
Mesh Joined(const Mesh& a, Mesh b) {
  for (uint64_t& key : b.key) key += uint64_t{1} << 6U;
  return MergeMeshes({a, b});
}

TEST(FillGroundHoles, ClosesAndMarksAHole) {
  for (const double spacing_m : {0.0, 0.3, 1.0, 100.0}) {
    Mesh mesh = GroundWithHole();
    const size_t n_before = mesh.position.size();
    EXPECT_NEAR(FillGroundHoles(&mesh, 30.0, spacing_m), 16.0, 1e-9);
    const EdgeCounts counts = CountEdges(mesh);
    EXPECT_EQ(counts.boundary, 80);
    EXPECT_EQ(counts.non_manifold, 0);
    EXPECT_NEAR(Area(mesh), 400.0, 1e-9);
    EXPECT_NEAR(FilledArea(mesh), 16.0, 1e-9) << "a triangle of the patch is not marked, or one beside it is";
    std::set<uint64_t> keys;
    for (size_t v = 0; v < mesh.position.size(); ++v) {
      EXPECT_EQ(mesh.filled[v], v < n_before ? 0 : 1);
      EXPECT_EQ(mesh.views[v] == 0, v >= n_before);
      EXPECT_EQ((mesh.key[v] & kFilledKeyBit) != 0, v >= n_before);
      EXPECT_TRUE(keys.insert(mesh.key[v]).second);
    }
    for (const Triangle& t : mesh.triangle) EXPECT_GT(DoubleAreaNormal(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]).z(), 0.0);
  }
}

TEST(FillGroundHoles, FinerSpacingGivesMoreVertices) {
  Mesh coarse = GroundWithHole(), fine = coarse;
  FillGroundHoles(&coarse, 30.0, 2.0);
  FillGroundHoles(&fine, 30.0, 0.5);
  EXPECT_GT(fine.position.size(), coarse.position.size() + 20);
  EXPECT_LT(fine.position.size(), coarse.position.size() + 300);
}

TEST(FillGroundHoles, FollowsASlope) {
  Mesh mesh = GroundWithHole([](int x, int y) { return 0.3 * x - 0.1 * y; });
  EXPECT_GT(FillGroundHoles(&mesh, 30.0, 0.7), 16.0);
  for (const Eigen::Vector3d& x : mesh.position) EXPECT_NEAR(x.z(), 0.3 * x.x() - 0.1 * x.y(), 0.02);
}

TEST(FillGroundHoles, LeavesTheOutlineAndLargeHolesOpen) {
  Mesh mesh = GroundWithHole();
  const Mesh before = mesh;
  EXPECT_EQ(FillGroundHoles(&mesh, 15.9, 1.0), 0.0);
  EXPECT_EQ(mesh.triangle, before.triangle);
  EXPECT_EQ(FillGroundHoles(&mesh, 0.0, 1.0), 0.0);
  EXPECT_EQ(FillGroundHoles(&mesh, std::nan(""), 1.0), 0.0);
  EXPECT_NEAR(FillGroundHoles(&mesh, 1e9, 1.0), 16.0, 1e-9);  // not the outline as well
}

TEST(FillGroundHoles, LeavesWallsAndCeilingsOpen) {
  Mesh wall = GroundWithHole();
  for (Eigen::Vector3d& x : wall.position) x = {x.x(), 0.05 * x.y(), x.y()};
  EXPECT_EQ(FillGroundHoles(&wall, 30.0, 1.0), 0.0);
  Mesh ceiling = GroundWithHole();
  for (Triangle& t : ceiling.triangle) std::swap(t[1], t[2]);
  EXPECT_EQ(FillGroundHoles(&ceiling, 1000.0, 1.0), 0.0);
}

TEST(FillGroundHoles, LeavesStepsOpen) {
  // Ground on two levels, 3 m apart, with the step inside the hole's rows.
  Mesh mesh = GroundWithHole([](int x, int) { return x < 10 ? 0.0 : 3.0; });
  EXPECT_EQ(FillGroundHoles(&mesh, 30.0, 1.0), 0.0);
  Mesh low = GroundWithHole([](int x, int) { return x < 10 ? 0.0 : 0.5; });
  EXPECT_GT(FillGroundHoles(&low, 30.0, 1.0), 0.0);
}

TEST(FillGroundHoles, LeavesHolesAroundBuildingsOpen) {
  // A roof of 2 m x 2 m high above the hole.
  Mesh roof = GridMesh(9, 9, 11, 11, [](int, int) { return 12.0; });
  Mesh mesh = Joined(GroundWithHole(), roof);
  EXPECT_EQ(FillGroundHoles(&mesh, 30.0, 1.0), 0.0);
  // One that covers the hole without a vertex inside it.
  Mesh large;
  large.position = {{-50, -50, 9}, {80, -50, 9}, {0, 80, 9}};
  large.key = {7, 8, 9};
  large.views = {3, 3, 3};
  large.filled = {0, 0, 0};
  large.triangle = {{0, 1, 2}};
  mesh = Joined(GroundWithHole(), large);
  EXPECT_EQ(FillGroundHoles(&mesh, 30.0, 1.0), 0.0);
  // A beam across it.
  large.position = {{-5, 10.2, 9}, {25, 10.2, 9}, {25, 10.4, 9}};
  mesh = Joined(GroundWithHole(), large);
  EXPECT_EQ(FillGroundHoles(&mesh, 30.0, 1.0), 0.0);
  // A roof with the same outline.
  mesh = GridMesh(0, 0, 9, 9, Flat, [](int x, int y) { return x != 4 || y != 4; });
  mesh = Joined(mesh, GridMesh(4, 4, 5, 5, [](int, int) { return 3.0; }));
  EXPECT_EQ(FillGroundHoles(&mesh, 30.0, 1.0), 0.0);
  // Beside it, and deep below, they do no harm.
  for (Eigen::Vector3d& x : roof.position) x.x() += 3.0;
  mesh = Joined(GroundWithHole(), roof);
  EXPECT_NEAR(FillGroundHoles(&mesh, 30.0, 1.0), 16.0, 1e-9);
  for (Eigen::Vector3d& x : roof.position) x = {x.x() - 3.0, x.y(), -4.0};
  mesh = Joined(GroundWithHole(), roof);
  EXPECT_NEAR(FillGroundHoles(&mesh, 30.0, 1.0), 16.0, 1e-9);
}

TEST(FillGroundHoles, LeavesBordersThatTouchOpen) {
  // Two holes with a common corner.
  Mesh mesh = GridMesh(0, 0, 10, 10, Flat, [](int x, int y) { return !((x == 4 && y == 4) || (x == 5 && y == 5)); });
  EXPECT_EQ(FillGroundHoles(&mesh, 30.0, 1.0), 0.0);
}

TEST(FillGroundHoles, TwiceGivesDifferentKeys) {
  Mesh mesh = GridMesh(0, 0, 20, 20, Flat, [](int x, int y) { return !(y == 5 && (x == 4 || (x >= 10 && x < 13))); });
  DropUnusedVertices(&mesh);
  EXPECT_NEAR(FillGroundHoles(&mesh, 1.5, 0.5), 1.0, 1e-9);
  EXPECT_NEAR(FillGroundHoles(&mesh, 30.0, 0.5), 3.0, 1e-9);
  std::sort(mesh.key.begin(), mesh.key.end());
  EXPECT_EQ(std::adjacent_find(mesh.key.begin(), mesh.key.end()), mesh.key.end());
  EXPECT_EQ(FillGroundHoles(&mesh, 1e6, 0.5), 0.0);
}

TEST(FillGroundHoles, TakesOddMeshes) {
  Mesh empty;
  EXPECT_EQ(FillGroundHoles(&empty, 30.0, 1.0), 0.0);
  Mesh one = GridMesh(0, 0, 1, 1, Flat);
  EXPECT_EQ(FillGroundHoles(&one, 30.0, 1.0), 0.0);
  Mesh nan = GroundWithHole([](int x, int y) { return x == 12 && y == 10 ? std::nan("") : 0.0; });
  EXPECT_EQ(FillGroundHoles(&nan, 30.0, 1.0), 0.0);
}

// Holes of any form: unions of cells that were taken out, closed or not, leave a manifold whose border only shrinks.
RC_GTEST_PROP(FillGroundHoles, AnyHolesLeaveAManifold, ()) {
  const int seed = *rc::gen::inRange(0, 100000);
  const double missing = *rc::gen::element(-1.5, -1.0, -0.6), sigma = *rc::gen::element(0.0, 0.2), spacing_m = *rc::gen::element(0.0, 0.4, 1.5);
  Mesh mesh = GridMesh(
      0, 0, 16, 16, [&](int x, int y) { return Noise(x, y + seed, sigma); },
      [&](int x, int y) { return x == 0 || y == 0 || x == 15 || y == 15 || Noise(x + seed, y, 1.0) > missing; });
  DropUnusedVertices(&mesh);
  // Places that touch at a vertex are not manifold in the vertex, which is allowed.
  const Mesh before = mesh;
  const double area = FillGroundHoles(&mesh, 50.0, spacing_m);
  RC_ASSERT(CountEdges(mesh).non_manifold == 0);
  RC_ASSERT(CountEdges(mesh).boundary <= CountEdges(before).boundary);
  RC_ASSERT((area > 0.0) == (mesh.triangle.size() > before.triangle.size()));
  RC_ASSERT(std::abs(Area(mesh) - Area(before) - area) < 1e-9 * Area(mesh));
  // Seen from above nothing is covered twice.
  double from_above = 0.0;
  for (const Triangle& t : mesh.triangle) {
    const double double_area = DoubleAreaFromAbove(mesh.position[t[0]].head<2>(), mesh.position[t[1]].head<2>(), mesh.position[t[2]].head<2>());
    RC_ASSERT(double_area > 0.0);
    from_above += 0.5 * double_area;
  }
  RC_ASSERT(from_above < 256.0 + 1e-6);
}

}  // namespace
}  // namespace skyquilt::surface
