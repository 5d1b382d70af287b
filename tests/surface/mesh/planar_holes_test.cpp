#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "made_meshes.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

// A plane of 20 m x 20 m with a hole of 4 m x 4 m, in the ground's place.
Mesh SheetWithHole(const HeightOf& height = Flat) {
  Mesh mesh = GridMesh(0, 0, 20, 20, height, [](int x, int y) { return x < 8 || x >= 12 || y < 8 || y >= 12; });
  DropUnusedVertices(&mesh);
  return mesh;
}

// Stands it up as a wall that faces south: what was up is in front.
Mesh StoodUp(Mesh mesh) {
  for (Eigen::Vector3d& x : mesh.position) x = {x.x(), -x.z(), x.y()};
  return mesh;
}

Mesh With(const Mesh& a, Mesh b) {
  for (uint64_t& key : b.key) key += uint64_t{1} << 6U;
  return MergeMeshes({a, b});
}

double Fill(Mesh* mesh, const IsOpenThere& is_open = nullptr, double max_area_m2 = 30.0) {
  return FillPlanarHoles(mesh, max_area_m2, 1.0, 0.3, is_open);
}

TEST(FillPlanarHoles, ClosesAndMarksAHoleInAWall) {
  Mesh mesh = StoodUp(SheetWithHole());
  const size_t n_before = mesh.position.size();
  EXPECT_NEAR(Fill(&mesh), 16.0, 1e-9);
  EXPECT_EQ(CountEdges(mesh).boundary, 80);
  EXPECT_EQ(CountEdges(mesh).non_manifold, 0);
  EXPECT_NEAR(Area(mesh), 400.0, 1e-9);
  ASSERT_GT(mesh.position.size(), n_before);
  for (size_t v = 0; v < mesh.position.size(); ++v) {
    EXPECT_NEAR(mesh.position[v].y(), 0.0, 1e-9);
    EXPECT_EQ(mesh.filled[v], v < n_before ? 0 : 1);
    EXPECT_EQ(mesh.views[v] == 0, v >= n_before);
    EXPECT_EQ((mesh.key[v] & kFilledKeyBit) != 0, v >= n_before);
  }
  for (const Triangle& t : mesh.triangle) EXPECT_LT(DoubleAreaNormal(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]).y(), 0.0);
}

TEST(FillPlanarHoles, InAnyDirectionAndInCeilings) {
  for (const double angle : {1.2, 1.6, 2.4, -1.9}) {
    Mesh mesh = SheetWithHole();
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Eigen::Vector3d(1.0, 2.0, 0.5).normalized()).toRotationMatrix();
    for (Eigen::Vector3d& x : mesh.position) x = turn * x + Eigen::Vector3d(500.0, -300.0, 20.0);
    EXPECT_NEAR(Fill(&mesh), 16.0, 1e-6) << angle;
    EXPECT_EQ(CountEdges(mesh).non_manifold, 0);
  }
  Mesh ceiling = SheetWithHole();
  for (Triangle& t : ceiling.triangle) std::swap(t[1], t[2]);
  EXPECT_NEAR(Fill(&ceiling), 16.0, 1e-9);
}

TEST(FillPlanarHoles, FollowsASlightlyRoughBorder) {
  Mesh mesh = StoodUp(SheetWithHole([](int x, int y) { return Noise(x, y, 0.05); }));
  EXPECT_NEAR(Fill(&mesh), 16.0, 1.0);
  EXPECT_EQ(CountEdges(mesh).boundary, 80);
  for (const Eigen::Vector3d& x : mesh.position) EXPECT_LT(std::abs(x.y()), 0.3);
}

TEST(FillPlanarHoles, LeavesTheGroundAsItIs) {
  Mesh mesh = SheetWithHole();
  const Mesh before = mesh;
  EXPECT_EQ(Fill(&mesh), 0.0) << "FillGroundHoles would close it";
  EXPECT_EQ(mesh.triangle, before.triangle);
  Mesh roofed = With(mesh, GridMesh(9, 9, 11, 11, [](int, int) { return 12.0; }));
  EXPECT_EQ(Fill(&roofed), 0.0) << "FillGroundHoles leaves it open";
}

TEST(FillPlanarHoles, LeavesBordersOffThePlaneLargeHolesAndOutlinesOpen) {
  Mesh step = StoodUp(SheetWithHole([](int x, int) { return x < 10 ? 0.0 : 3.0; }));
  EXPECT_EQ(Fill(&step), 0.0);
  Mesh mesh = StoodUp(SheetWithHole());
  EXPECT_EQ(Fill(&mesh, nullptr, 15.9), 0.0);
  EXPECT_EQ(Fill(&mesh, nullptr, 0.0), 0.0);
  EXPECT_EQ(Fill(&mesh, nullptr, std::nan("")), 0.0);
  EXPECT_NEAR(Fill(&mesh, nullptr, 1e9), 16.0, 1e-9) << "not the outline as well";
}

TEST(FillPlanarHoles, LeavesOpeningsOpen) {
  Mesh mesh = StoodUp(SheetWithHole());
  const auto is_open = [](const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
    EXPECT_NEAR(normal.y(), -1.0, 1e-9);
    EXPECT_NEAR(x.y(), 0.0, 1e-9);
    return x.x() > 11.0;  // a part of it
  };
  EXPECT_EQ(Fill(&mesh, is_open), 0.0);
  EXPECT_NEAR(Fill(&mesh, [](const Eigen::Vector3d& x, const Eigen::Vector3d&) { return x.x() > 13.0; }), 16.0, 1e-9);
}

TEST(FillPlanarHoles, LeavesHolesWithSomethingInThemOpen) {
  const auto with_plate = [](double in_front_m) {
    return StoodUp(With(SheetWithHole(), GridMesh(9, 9, 11, 11, [&](int, int) { return in_front_m; })));
  };
  for (const double in_front_m : {0.2, -0.2}) {
    Mesh mesh = with_plate(in_front_m);
    EXPECT_EQ(Fill(&mesh), 0.0);
  }
  for (const double in_front_m : {2.0, -2.0}) {
    Mesh mesh = with_plate(in_front_m);
    EXPECT_NEAR(Fill(&mesh), 16.0, 1e-9) << "a picture in front of the wall, or a room behind it";
  }
}

TEST(FillPlanarHoles, TakesOddMeshes) {
  Mesh empty;
  EXPECT_EQ(Fill(&empty), 0.0);
  Mesh nan = StoodUp(SheetWithHole([](int x, int y) { return x == 12 && y == 10 ? std::nan("") : 0.0; }));
  EXPECT_EQ(Fill(&nan), 0.0);
  Mesh line = GridMesh(0, 0, 3, 1, Flat);
  for (Eigen::Vector3d& x : line.position) x = {x.x(), 0.0, 0.0};
  EXPECT_EQ(Fill(&line), 0.0);
}

}  // namespace
}  // namespace skyquilt::surface
