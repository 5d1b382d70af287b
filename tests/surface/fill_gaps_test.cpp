#include "surface/fill_gaps.h"

#include <gtest/gtest.h>

#include <set>

#include "surface/mesh/mesh_tools.h"
#include "texture/texture_meshes.h"

namespace skyquilt::surface {
namespace {

using testing::FilledView;
using testing::HeightField;
using testing::PoseAt;
using testing::ViewOf;

constexpr double kCoarse_m = 0.4;

// A level square of 8 x 8 m in steps of 0.1 m without its triangles inside the square from `low` to `high`.
Mesh WithHole(double low, double high) {
  Mesh mesh = HeightField(80, 0.1, [](double, double) { return 0.0; });
  std::erase_if(mesh.triangle, [&](const Triangle& t) {
    const Eigen::Vector3d middle = (mesh.position[t[0]] + mesh.position[t[1]] + mesh.position[t[2]]) / 3.0;
    return middle.x() > low && middle.x() < high && middle.y() > low && middle.y() < high;
  });
  DropUnusedVertices(&mesh);
  return mesh;
}

Mesh CoarseAt(double z) {
  return HeightField(20, kCoarse_m, [z](double, double) { return z; });
}

FilledView FromAbove(int photo) {
  return ViewOf(PoseAt({4, 4, 10}, -Eigen::Vector3d::UnitZ(), 160, 230.0, photo), testing::PlaneAtZero);
}

// Area of the filled triangles and their box.
struct Filled {
  double area_m2 = 0.0;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = Eigen::Vector3d::Constant(-1e9);
};
Filled FilledOf(const Mesh& mesh) {
  Filled filled;
  Mesh part;
  part.position = mesh.position;
  for (const Triangle& t : mesh.triangle) {
    if (mesh.filled[t[0]] == 0) continue;
    part.triangle.push_back(t);
    for (const uint32_t v : t) {
      EXPECT_EQ(mesh.filled[v], 1);
      EXPECT_EQ(mesh.views[v], 0);
      filled.low = filled.low.cwiseMin(mesh.position[v]);
      filled.high = filled.high.cwiseMax(mesh.position[v]);
    }
  }
  filled.area_m2 = Area(part);
  return filled;
}

double Fill(const Mesh& coarse, const FilledView& view, Mesh* mesh, int n_threads = 2) {
  base::ThreadPool threads(n_threads);
  const std::vector<DepthView> views = {view.Get()};
  return FillGaps(coarse, kCoarse_m, views, threads, mesh);
}

TEST(FillGaps, ClosesAHoleAndLittleAroundIt) {
  Mesh mesh = WithHole(3.0, 5.0);
  const size_t before = mesh.triangle.size();
  const double area = Fill(CoarseAt(-0.05), FromAbove(0), &mesh);
  const Filled filled = FilledOf(mesh);
  EXPECT_GT(mesh.triangle.size(), before);
  EXPECT_NEAR(area, filled.area_m2, 0.02 * area);
  EXPECT_GE(area, 4.0);
  EXPECT_LT((filled.high - filled.low).head<2>().maxCoeff(), 2.0 + 5.0 * kCoarse_m);
  EXPECT_LT(filled.low.head<2>().maxCoeff(), 3.0);
  EXPECT_GT(filled.high.head<2>().minCoeff(), 5.0);
  // The rim lies behind the mesh, the middle where the coarse mesh has it.
  EXPECT_NEAR(filled.low.z(), -0.05 - 0.5 * kCoarse_m, 1e-6);
  EXPECT_NEAR(filled.high.z(), -0.05, 1e-6);
  EXPECT_EQ(std::set<uint64_t>(mesh.key.begin(), mesh.key.end()).size(), mesh.key.size());
}

TEST(FillGaps, AddsNothingToAWholeMesh) {
  Mesh mesh = WithHole(9.0, 9.0);
  const size_t before = mesh.triangle.size();
  EXPECT_EQ(Fill(CoarseAt(-0.05), FromAbove(0), &mesh), 0.0);
  EXPECT_EQ(Fill(CoarseAt(0.1), FromAbove(0), &mesh), 0.0);  // in front of the mesh, but no more than a voxel
  EXPECT_EQ(mesh.triangle.size(), before);
}

// The photo sees the ground: a coarse web above it is wrong.
TEST(FillGaps, PutsNothingBeforeWhatPhotosSee) {
  Mesh mesh = WithHole(9.0, 9.0);
  EXPECT_EQ(Fill(CoarseAt(2.0), FromAbove(0), &mesh), 0.0);
  FilledView unsure = FromAbove(0);
  std::fill(unsure.depth_m.begin(), unsure.depth_m.end(), std::nanf(""));
  EXPECT_GT(Fill(CoarseAt(2.0), unsure, &mesh), 20.0);
}

TEST(FillGaps, OnlyPhotosTellWhereGapsAre) {
  Mesh mesh = WithHole(3.0, 5.0);
  EXPECT_EQ(Fill(CoarseAt(-0.05), FromAbove(-1), &mesh), 0.0);
  const FilledView away = ViewOf(PoseAt({4, 4, 10}, Eigen::Vector3d::UnitZ(), 160, 160.0, 0), testing::PlaneAtZero);
  EXPECT_EQ(Fill(CoarseAt(-0.05), away, &mesh), 0.0);
  EXPECT_EQ(Fill({}, FromAbove(0), &mesh), 0.0);
}

TEST(FillGaps, IsTheSameForAnyNumberOfThreads) {
  Mesh one = WithHole(3.0, 5.0), four = one;
  Fill(CoarseAt(-0.05), FromAbove(0), &one, 1);
  Fill(CoarseAt(-0.05), FromAbove(0), &four, 4);
  EXPECT_EQ(one.triangle, four.triangle);
  EXPECT_EQ(one.key, four.key);
}

}  // namespace
}  // namespace skyquilt::surface
