#include "surface/fusion/extract.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>

#include "core/base/random.h"
#include "surface/fusion/cell_cycles.h"
#include "tests/surface/fusion/analytic_views.h"

namespace skyquilt::surface {
namespace {

constexpr int kSide = 14;  // nodes of the known cube; two bricks along each axis

struct Lattice {
  Bricks bricks;
  NodeField field;

  // Two bricks along each axis, around the origin. Nothing is known.
  Lattice() {
    for (int z = -1; z < 1; ++z) {
      for (int y = -1; y < 1; ++y) {
        for (int x = -1; x < 1; ++x) bricks.key.push_back(BrickKey(x, y, z));
      }
    }
    const size_t n = bricks.size() * static_cast<size_t>(kBrickNodes);
    field.psi.assign(n, std::numeric_limits<float>::quiet_NaN());
    field.views.assign(n, 9);
    field.photos.assign(n, 9);
  }
  size_t Index(int x, int y, int z) const {
    const int64_t brick = bricks.Find({BrickOfNode(x), BrickOfNode(y), BrickOfNode(z)});
    return static_cast<size_t>(brick) * static_cast<size_t>(kBrickNodes) + NodeInBrick(x, y, z);
  }
  template <typename Set>
  void ForNodes(const Set& set) {
    for (int z = -kSide / 2; z < kSide / 2; ++z) {
      for (int y = -kSide / 2; y < kSide / 2; ++y) {
        for (int x = -kSide / 2; x < kSide / 2; ++x) set(Index(x, y, z));
      }
    }
  }
};

FuseOptions UnitVoxels() {
  FuseOptions options;
  options.voxel_m = 1.0;
  return options;
}

const LatticeBox kAll{{-20, -20, -20}, {20, 20, 20}};

// Random signs have every kind of cell and every kind of neighbours, among them faces that both cells would link twice.
RC_GTEST_PROP(ExtractMesh, AnySignsGiveAManifold, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  const double share_inside = *rc::gen::inRange(20, 81) / 100.0;
  Lattice lattice;
  lattice.ForNodes([&](size_t i) {
    const double size = random.UniformDouble() < 0.1 ? 0.0 : random.UniformDouble();
    lattice.field.psi[i] = static_cast<float>(random.UniformDouble() < share_inside ? -size : size);
  });
  base::ThreadPool threads(1);
  const Mesh mesh = ExtractMesh(lattice.bricks, lattice.field, kAll, UnitVoxels(), threads);
  RC_ASSERT(mesh.triangle.size() > 1000U);
  const test::MeshCheck check = test::CheckMesh(mesh);
  RC_ASSERT(check.bad_edges == 0);
  RC_ASSERT(check.bad_vertices.empty());
  RC_ASSERT(check.degenerate == 0);
  // All quads whose four cells are known are there, so the mesh ends at the border of the known cube only: in its outer layer of cells.
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const Triangle& t : mesh.triangle) {
    for (size_t i = 0; i < 3; ++i) edges.insert({t[i], t[(i + 1) % 3]});
  }
  const auto in_outer_layer = [&](uint32_t v) { return mesh.position[v].cwiseAbs().maxCoeff() > kSide / 2 - 2; };
  for (const auto& [a, b] : edges) {
    if (!edges.contains({b, a})) RC_ASSERT(in_outer_layer(a) && in_outer_layer(b));
  }
}

RC_GTEST_PROP(ExtractMesh, UnknownAndUnseenNodesLeaveAManifold, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  Lattice lattice;
  lattice.ForNodes([&](size_t i) {
    const float unknown = std::numeric_limits<float>::quiet_NaN();
    lattice.field.psi[i] = random.UniformDouble() < 0.04 ? unknown : static_cast<float>(random.UniformDouble() - 0.5);
    lattice.field.views[i] = static_cast<uint8_t>(5.0 * random.UniformDouble());
    lattice.field.photos[i] = static_cast<uint8_t>(4.0 * random.UniformDouble());
  });
  base::ThreadPool threads(1);
  const Mesh mesh = ExtractMesh(lattice.bricks, lattice.field, kAll, UnitVoxels(), threads);
  RC_ASSERT(!mesh.triangle.empty());
  const test::MeshCheck check = test::CheckMesh(mesh);
  RC_ASSERT(check.bad_edges == 0);
  RC_ASSERT(check.bad_vertices.empty());
  // Keys name vertices.
  RC_ASSERT(std::set<uint64_t>(mesh.key.begin(), mesh.key.end()).size() == mesh.key.size());
  RC_ASSERT(*std::min_element(mesh.views.begin(), mesh.views.end()) >= 3);
}

TEST(ExtractMesh, SplitsTwoSheetsThatShareAFaceTwice) {
  // Two diagonal tunnels through a solid touch at one face: z = 0, with all corners inside above and below it. Four quads would meet at one edge.
  Lattice lattice;
  lattice.ForNodes([&](size_t i) { lattice.field.psi[i] = -0.5F; });
  lattice.field.psi[lattice.Index(0, 0, 0)] = 0.5F;
  lattice.field.psi[lattice.Index(1, 1, 0)] = 0.5F;
  base::ThreadPool threads(1);
  const Mesh mesh = ExtractMesh(lattice.bricks, lattice.field, kAll, UnitVoxels(), threads);
  const test::MeshCheck check = test::CheckMesh(mesh);
  EXPECT_EQ(mesh.triangle.size(), 24U);
  EXPECT_EQ(check.bad_edges, 0);
  EXPECT_TRUE(check.bad_vertices.empty());
  EXPECT_EQ(check.boundary_edges, 0);
  EXPECT_LT(test::SignedVolume(mesh), 0.0);
}

TEST(ExtractMesh, OneNodeInsideIsASmallClosedBody) {
  Lattice lattice;
  lattice.ForNodes([&](size_t i) { lattice.field.psi[i] = 0.5F; });
  lattice.field.psi[lattice.Index(-1, -1, -1)] = -0.5F;
  base::ThreadPool threads(1);
  const Mesh mesh = ExtractMesh(lattice.bricks, lattice.field, kAll, UnitVoxels(), threads);
  EXPECT_EQ(mesh.position.size(), 8U);
  EXPECT_EQ(mesh.triangle.size(), 12U);
  EXPECT_EQ(test::CheckMesh(mesh).boundary_edges, 0);
  // A cube around the node (-1, -1, -1) with a side of twice the mean of (1/2, 0, 0), (0, 1/2, 0) and (0, 0, 1/2).
  EXPECT_NEAR(test::SignedVolume(mesh), 1.0 / 27.0, 1e-12);
  for (const Eigen::Vector3d& x : mesh.position) EXPECT_NEAR((x + Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(), 1.0 / 6.0, 1e-12);
}

TEST(CellTable, CyclesUseEachCrossingEdgeOnce) {
  int n_doubtful = 0;
  for (unsigned signs = 0; signs < 256; ++signs) {
    n_doubtful += Cells().doubtful_face[signs] >= 0 ? 1 : 0;
    for (const CellCycles* cell : {&Cells().cycles[signs], &Cells().turned[signs]}) {
      std::array<int, kCellEdges> used{};
      size_t at = 0;
      // Vertices that a cell may need when some quads are dropped: one per run of kept edges. They must fit into the four sheets of VertexKey.
      int n_vertices = 0;
      for (size_t i = 0; i < static_cast<size_t>(cell->n_cycles); ++i) {
        EXPECT_GE(cell->length[i], 3);
        n_vertices += std::max(1, cell->length[i] / 2);
        for (size_t n = 0; n < cell->length[i]; ++n) ++used[cell->edges[at++]];
      }
      EXPECT_LE(n_vertices, 4);
      for (int edge = 0; edge < kCellEdges; ++edge) {
        const int lower = LowerCornerOfEdge(edge);
        const int upper = lower | 1 << edge / 4;
        ASSERT_NE(lower, upper);
        EXPECT_EQ(used[static_cast<size_t>(edge)],
                  static_cast<int>((signs >> static_cast<unsigned>(lower) ^ signs >> static_cast<unsigned>(upper)) & 1U));
      }
    }
  }
  // Two diagonals on each of six faces; the other four corners are inside, or three of them.
  EXPECT_EQ(n_doubtful, 6 * 2 * 3);
}

}  // namespace
}  // namespace skyquilt::surface
