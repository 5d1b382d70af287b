#include "surface/texture/charts.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "texture_meshes.h"

namespace skyquilt::surface {
namespace {

using testing::Append;
using testing::Box;
using testing::HeightField;
using testing::RandomTown;

TexelLattice LatticeOf(const TileGeometry& geometry, double texel_m) {
  return {DirectionsOf(geometry), geometry.min_enu, texel_m};
}

// How often each texel centre of a chart is covered at most.
int MostOverlap(const TileGeometry& geometry, const TexelLattice& lattice, const Chart& chart) {
  std::map<std::pair<int, int>, int> count;
  int most = 0;
  for (const uint32_t t : chart.triangle) {
    ForEachCentreInside(lattice.Of(chart.direction, geometry, t), [&](int x, int y, double, double) { most = std::max(most, ++count[{x, y}]); });
  }
  return most;
}

RC_GTEST_PROP(Charts, HoldEachTriangleOnceWithoutOverlap, ()) {
  const auto seed = *rc::gen::arbitrary<uint64_t>();
  const double roughness = *rc::gen::element(0.0, 0.2, 1.0);
  const double texel_m = *rc::gen::element(0.03, 0.1, 0.7);
  const Mesh mesh = RandomTown(seed, roughness);
  const TileGeometry geometry = GeometryOf(mesh);
  const TexelLattice lattice = LatticeOf(geometry, texel_m);
  const auto charts = MakeCharts(geometry, lattice, 100000);
  RC_ASSERT(charts.has_value());
  std::vector<int> times(geometry.triangle.size(), 0);
  for (const Chart& chart : *charts) {
    RC_ASSERT(!chart.triangle.empty());
    RC_ASSERT(MostOverlap(geometry, lattice, chart) <= 1);
    for (const uint32_t t : chart.triangle) {
      ++times[t];
      RC_ASSERT(geometry.face_normal[t].dot(lattice.directions[static_cast<size_t>(chart.direction)].out) > kLeastChartCosine);
      for (const Eigen::Vector2d& corner : lattice.Of(chart.direction, geometry, t)) {
        const Eigen::Vector2d in_chart = corner - chart.corner.cast<double>();
        RC_ASSERT(in_chart.minCoeff() >= 0.0 && (chart.size.cast<double>() - in_chart).minCoeff() >= 0.0);
      }
    }
  }
  RC_ASSERT(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
}

// Centres on shared edges are neither lost nor counted twice: all vertices are at texel centres.
TEST(Charts, EachCentreOfAFlatSurfaceBelongsToOneTriangle) {
  const Mesh mesh = HeightField(6, 1.0, [](double, double) { return 0.0; });
  std::map<std::pair<int, int>, int> count;
  for (const Triangle& t : mesh.triangle) {
    TexelTriangle corners;
    for (size_t i = 0; i < 3; ++i) corners[i] = mesh.position[t[i]].head<2>() * 2.0 + Eigen::Vector2d(0.5, 0.5);
    ForEachCentreInside(corners, [&](int x, int y, double, double) { ++count[{x, y}]; });
  }
  EXPECT_EQ(count.size(), 144U);
  for (const auto& [texel, n] : count) EXPECT_EQ(n, 1);
}

TEST(Charts, AxesAreSeenFromOutsideAndNotMirrored) {
  const TileGeometry geometry = GeometryOf(Box({0, 0, 0}, {1, 2, 3}, 0.4));
  for (const ChartDirection& d : DirectionsOf(geometry)) {
    EXPECT_LT((d.u.cross(d.v) + d.out).norm(), 1e-12);  // right x down = into the surface
    EXPECT_NEAR(d.u.norm(), 1.0, 1e-12);
  }
}

TEST(Charts, FollowTheFacades) {
  for (const double turn : {0.0, 0.01, 0.3, 1.1, 1.56}) {
    const Mesh mesh = Box({0, 0, 0}, {8, 5, 4}, turn);
    const TileGeometry geometry = GeometryOf(mesh);
    EXPECT_NEAR(std::remainder(FacadeAzimuth(geometry) - turn, std::numbers::pi / 2), 0.0, 0.02) << turn;
    const auto charts = MakeCharts(geometry, LatticeOf(geometry, 0.1), 4096);
    ASSERT_TRUE(charts);
    EXPECT_EQ(charts->size(), 6U) << turn;
  }
}

TEST(Charts, SingleTrianglesFollowTheirNeighbours) {
  // One vertex of a level grid is raised, so that its triangles lean sideways, but not beyond what 'up' can show.
  Mesh mesh = HeightField(20, 1.0, [](double x, double y) { return x == 10.0 && y == 10.0 ? 1.3 : 0.0; });
  const TileGeometry geometry = GeometryOf(mesh);
  const auto charts = MakeCharts(geometry, LatticeOf(geometry, 0.4), 4096);
  ASSERT_TRUE(charts);
  EXPECT_EQ(charts->size(), 1U);
}

TEST(Charts, SmallPiecesJoinOnlyWhereTheirTrianglesStayVisible) {
  Mesh mesh = HeightField(20, 1.0, [](double, double) { return 0.0; });
  Append(&mesh, Box({5, 5, 1}, {5.1, 5.1, 1.1}));  // smaller than the limit on all sides, but its faces are at right angles
  const TileGeometry geometry = GeometryOf(mesh);
  const auto charts = MakeCharts(geometry, LatticeOf(geometry, 0.1), 4096);
  ASSERT_TRUE(charts);
  EXPECT_EQ(charts->size(), 7U);
}

// A ramp of two turns, like a spiral staircase: one connected surface that faces up and lies above itself.
TEST(Charts, ASurfaceAboveItselfIsSplit) {
  Mesh mesh;
  constexpr int kSteps = 64;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = 4.0 * std::numbers::pi * i / kSteps;
    for (const double radius : {2.0, 4.0}) testing::AddVertex(&mesh, {radius * std::cos(angle), radius * std::sin(angle), 0.1 * i});
  }
  for (uint32_t i = 0; i < kSteps; ++i) {
    mesh.triangle.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    mesh.triangle.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  const TileGeometry geometry = GeometryOf(mesh);
  for (const double texel_m : {0.05, 0.5}) {
    const TexelLattice lattice = LatticeOf(geometry, texel_m);
    EXPECT_EQ(ConnectedCharts(geometry, lattice.directions, texel_m).size(), 1U);
    const auto charts = MakeCharts(geometry, lattice, 4096);
    ASSERT_TRUE(charts);
    EXPECT_GE(charts->size(), 2U);
    EXPECT_LE(charts->size(), 4U);
    for (const Chart& chart : *charts) EXPECT_LE(MostOverlap(geometry, lattice, chart), 1);
  }
}

// The same with triangles that are much smaller than a texel.
TEST(Charts, SmallTrianglesAboveOthersAreSplitToo) {
  Mesh mesh;
  constexpr int kSteps = 400;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = 4.0 * std::numbers::pi * i / kSteps;
    for (int ring = 0; ring <= 20; ++ring) {
      const double radius = 2.0 + 0.1 * ring;
      testing::AddVertex(&mesh, {radius * std::cos(angle), radius * std::sin(angle), 0.03 * i});
    }
  }
  for (uint32_t i = 0; i < kSteps; ++i) {
    for (uint32_t ring = 0; ring < 20; ++ring) {
      const uint32_t a = i * 21 + ring;
      mesh.triangle.push_back({a, a + 1, a + 22});
      mesh.triangle.push_back({a, a + 22, a + 21});
    }
  }
  const TileGeometry geometry = GeometryOf(mesh);
  const TexelLattice lattice = LatticeOf(geometry, 0.4);
  const auto charts = MakeCharts(geometry, lattice, 4096);
  ASSERT_TRUE(charts);
  EXPECT_GE(charts->size(), 2U);
  for (const Chart& chart : *charts) {
    EXPECT_LE(MostOverlap(geometry, lattice, chart), 1);
    std::map<std::pair<int, int>, std::pair<double, double>> depth;  // range per texel
    for (const uint32_t t : chart.triangle) {
      const Eigen::Vector3d x = geometry.PositionAt(t, 1.0 / 3.0, 1.0 / 3.0);
      const Eigen::Vector2d p = lattice.At(chart.direction, x);
      const double z = lattice.DepthAt(chart.direction, x);
      auto& range = depth.try_emplace({static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))}, z, z).first->second;
      range = {std::min(range.first, z), std::max(range.second, z)};
    }
    for (const auto& [texel, range] : depth) EXPECT_LT(range.second - range.first, 8.0);  // one turn rises by 15 texels
  }
}

TEST(Charts, UnusableTrianglesAreLeftOut) {
  Mesh mesh = HeightField(2, 1.0, [](double, double) { return 0.0; });
  const size_t good = mesh.triangle.size();
  mesh.triangle.push_back({0, 0, 1});
  mesh.triangle.push_back({0, 1, 2});  // on one line
  mesh.triangle.push_back({0, 1, 999});
  testing::AddVertex(&mesh, {std::nan(""), 0, 0});
  mesh.triangle.push_back({0, 1, static_cast<uint32_t>(mesh.position.size() - 1)});
  const TileGeometry geometry = GeometryOf(mesh);
  EXPECT_EQ(geometry.triangle.size(), good);
  EXPECT_LT((geometry.vertex_normal.back() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(Charts, NormalsOfVerticesAreWeightedByArea) {
  Mesh mesh;  // a roof: 3 square metres of one side, 1 of the other
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(6, 0, 0), Eigen::Vector3d(0, 0, -2)}) {
    testing::AddVertex(&mesh, x);
  }
  mesh.triangle = {{0, 2, 1}, {0, 1, 3}};
  const TileGeometry geometry = GeometryOf(mesh);
  EXPECT_LT((geometry.vertex_normal[0] - Eigen::Vector3d(-1, 0, 3).normalized()).norm(), 1e-12) << geometry.vertex_normal[0].transpose();
}

}  // namespace
}  // namespace skyquilt::surface
