// Pieces that are fused apart are parts of the same mesh.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>
#include <map>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "surface/fusion/fuse.h"
#include "tests/support/error_of.h"
#include "tests/surface/fusion/analytic_views.h"

namespace skyquilt::surface {
namespace {

FuseOptions PieceOptions() {
  FuseOptions options;
  options.voxel_m = 0.37;
  return options;
}

struct JoinedPieces {
  std::set<std::array<uint64_t, 3>> triangles;
  size_t n_triangles = 0;  // counted per piece: larger than the set when pieces overlap
  std::map<uint64_t, std::pair<Eigen::Vector3d, uint8_t>> vertices;
  bool same_bits = true;

  void Add(const Mesh& mesh) {
    const auto of_piece = test::KeyTriangles(mesh);
    triangles.insert(of_piece.begin(), of_piece.end());
    n_triangles += mesh.triangle.size();
    for (size_t v = 0; v < mesh.key.size(); ++v) {
      const auto [found, added] = vertices.emplace(mesh.key[v], std::pair(mesh.position[v], mesh.views[v]));
      if (!added && std::memcmp(found->second.first.data(), mesh.position[v].data(), sizeof(Eigen::Vector3d)) != 0) same_bits = false;
      if (!added && found->second.second != mesh.views[v]) same_bits = false;
    }
  }
};

test::Pictures RandomPictures(base::Random* random) {
  const auto uniform = [&](double low, double high) { return random->Uniform(low, high); };
  test::AnalyticScene scene;
  scene.planes.push_back({{0, 0, uniform(-4, 0)}, {uniform(-0.4, 0.4), uniform(-0.4, 0.4), 1.0}});
  for (int i = 0; i < 3; ++i) scene.spheres.push_back({{uniform(-7, 7), uniform(-7, 7), uniform(-3, 4)}, uniform(0.3, 3.0)});
  test::Pictures pictures;
  const std::vector<Eigen::Vector3d> directions = test::EvenDirections(8, true);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d target(uniform(-4, 4), uniform(-4, 4), 0);
    pictures.Add(scene, 30.0 * directions[static_cast<size_t>(i)], target, 60.0, 36, i % 3 == 2 ? -1 : i);
    // Depths of a rendering are not exact: noise makes all kinds of cells and holes.
    for (float& depth : pictures.depth_m.back()) depth += static_cast<float>(uniform(-0.5, 0.5));
  }
  return pictures;
}

RC_GTEST_PROP(Pieces, TogetherAreTheWhole, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  const test::Pictures pictures = RandomPictures(&random);
  const LatticeBox whole{{-20, -22, -13}, {21, 19, 14}};
  const int n_cuts = *rc::gen::inRange(1, 3);
  std::vector<int> cuts[2];
  for (int axis = 0; axis < 2; ++axis) {
    cuts[axis] = {whole.min[axis], whole.max[axis]};
    for (int i = 0; i < n_cuts; ++i) cuts[axis].push_back(*rc::gen::inRange(whole.min[axis] + 1, whole.max[axis]));
    std::sort(cuts[axis].begin(), cuts[axis].end());
  }
  base::ThreadPool threads(2);
  JoinedPieces joined;
  for (size_t i = 0; i + 1 < cuts[0].size(); ++i) {
    for (size_t j = 0; j + 1 < cuts[1].size(); ++j) {
      joined.Add(FusePiece(pictures.views, {{cuts[0][i], cuts[1][j], whole.min.z()}, {cuts[0][i + 1], cuts[1][j + 1], whole.max.z()}}, PieceOptions(),
                           threads));
    }
  }
  const Mesh mesh = FusePiece(pictures.views, whole, PieceOptions(), threads);
  RC_ASSERT(!mesh.triangle.empty());
  const test::MeshCheck check = test::CheckMesh(mesh);
  RC_ASSERT(check.bad_edges == 0);
  // At the border of a piece a vertex may lack quads in the middle of its fan: they belong to the piece next to it.
  for (const uint32_t v : check.bad_vertices) {
    const Eigen::Array3d in_voxels = mesh.position[v].array() / PieceOptions().voxel_m;
    RC_ASSERT((in_voxels < whole.min.cast<double>().array() + 1.0).any() || (in_voxels > whole.max.cast<double>().array() - 1.0).any());
  }
  RC_ASSERT(joined.triangles == test::KeyTriangles(mesh));
  RC_ASSERT(joined.n_triangles == mesh.triangle.size());
  joined.Add(mesh);
  RC_ASSERT(joined.same_bits);
}

// Ground with a house, from above.
test::Pictures Ground() {
  const test::AnalyticScene scene{.planes = {{{0, 0, 0.2}, {0, 0, 1}}}, .spheres = {}, .boxes = {{{-3, -3, 0}, {3, 4, 5}}}};
  test::Pictures pictures;
  for (int i = 0; i < 5; ++i) pictures.Add(scene, {3.0 * i - 6.0, 1.0, 40.0}, {3.0 * i - 6.0, 0.0, 0.0}, 70.0, 64, i);
  return pictures;
}

TEST(PlanPieces, CoverAllSurfaceOnce) {
  base::ThreadPool threads(2);
  const test::Pictures pictures = Ground();
  FuseOptions options = PieceOptions();
  options.tile_voxels = 16;
  const LatticeBox whole{{-200, -150, -10}, {210, 100, 40}};
  const std::set<std::array<uint64_t, 3>> expected = test::KeyTriangles(FusePiece(pictures.views, whole, options, threads));
  ASSERT_GT(expected.size(), 5000U);
  const double least = LargestTileBytes(pictures.views, whole, options, threads);
  ASSERT_GT(least, 0.0);
  size_t n_before = 0;
  for (const double memory : {1e12, 12.0 * least, 4.0 * least, least}) {
    const std::vector<LatticeBox> pieces = PlanPieces(pictures.views, whole, options, memory, threads);
    // Less memory, more pieces.
    ASSERT_GT(pieces.size(), n_before);
    n_before = pieces.size();
    JoinedPieces joined;
    for (const LatticeBox& piece : pieces) {
      EXPECT_EQ(piece.min.z(), whole.min.z());
      EXPECT_EQ(piece.max.z(), whole.max.z());
      EXPECT_TRUE((piece.min.array() >= whole.min.array()).all() && (piece.max.array() <= whole.max.array()).all());
      const Mesh mesh = FusePiece(pictures.views, piece, options, threads);
      joined.Add(mesh);
    }
    EXPECT_EQ(joined.triangles, expected);
    EXPECT_EQ(joined.n_triangles, expected.size());
    // Tiles far from the surface are in no piece.
    for (const LatticeBox& piece : pieces) EXPECT_LT(piece.max.x(), 120);
  }
  EXPECT_EQ(PlanPieces(pictures.views, whole, options, 1e12, threads).size(), 1U);
}

TEST(PlanPieces, SaysHowMuchMemoryIsMissing) {
  base::ThreadPool threads(1);
  const test::Pictures pictures = Ground();
  const LatticeBox whole{{-100, -100, -10}, {100, 100, 40}};
  const double least = LargestTileBytes(pictures.views, whole, PieceOptions(), threads);
  EXPECT_NO_THROW(PlanPieces(pictures.views, whole, PieceOptions(), least, threads));
  const std::string error = UsageErrorOf([&] { PlanPieces(pictures.views, whole, PieceOptions(), 0.99 * least, threads); });
  const std::string needed = std::to_string(static_cast<int>(std::ceil(least / 1e6))) + " MB";
  EXPECT_NE(error.find("--memory"), std::string::npos) << error;
  EXPECT_NE(error.find(needed), std::string::npos) << error;
  EXPECT_THROW(PlanPieces(pictures.views, whole, PieceOptions(), std::numeric_limits<double>::quiet_NaN(), threads), base::UsageError);
  // More voxels than keys.
  EXPECT_THROW(PlanPieces(pictures.views, {{-(1 << 19), 0, 0}, {9, 9, 9}}, PieceOptions(), 1e12, threads), base::UsageError);
}

TEST(PlanPieces, NoneWithoutSurface) {
  base::ThreadPool threads(1);
  const LatticeBox whole{{-100, -100, -10}, {100, 100, 40}};
  EXPECT_TRUE(PlanPieces(std::span<const DepthView>(), whole, PieceOptions(), 1.0, threads).empty());
  EXPECT_EQ(LargestTileBytes(std::span<const DepthView>(), whole, PieceOptions(), threads), 0.0);
  const test::Pictures pictures = Ground();
  EXPECT_TRUE(PlanPieces(pictures.views, {}, PieceOptions(), 1.0, threads).empty());
  EXPECT_TRUE(PlanPieces(pictures.views, {{300, 300, -10}, {400, 400, 40}}, PieceOptions(), 1.0, threads).empty());
}

}  // namespace
}  // namespace skyquilt::surface
