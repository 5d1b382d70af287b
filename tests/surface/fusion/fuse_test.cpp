#include "surface/fusion/fuse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "tests/surface/fusion/analytic_views.h"

namespace skyquilt::surface {
namespace {

constexpr double kVoxel = 0.5;

FuseOptions BallOptions() {
  FuseOptions options;
  options.voxel_m = kVoxel;
  return options;
}

LatticeBox Cube(int half) {
  return {Eigen::Vector3i::Constant(-half), Eigen::Vector3i::Constant(half)};
}

const test::AnalyticScene kBall{.planes = {}, .spheres = {{{0.7, -0.3, 0.4}, 10.0}}, .boxes = {}};

// Pixels of 1.3 voxels, as with the options' defaults.
test::Pictures Around(const test::AnalyticScene& scene, int n, bool upper_half) {
  test::Pictures pictures;
  int photo = 0;
  for (const Eigen::Vector3d& direction : test::EvenDirections(n, upper_half)) pictures.Add(scene, 60.0 * direction, {0, 0, 0}, 78.0, 64, photo++);
  return pictures;
}

double LargestError(const test::AnalyticScene& scene, const Mesh& mesh) {
  double largest = 0.0;
  for (const Eigen::Vector3d& x : mesh.position) largest = std::max(largest, scene.Distance(x));
  return largest;
}

double MeanError(const test::AnalyticScene& scene, const Mesh& mesh) {
  double sum = 0.0;
  for (const Eigen::Vector3d& x : mesh.position) sum += scene.Distance(x);
  return sum / static_cast<double>(mesh.position.size());
}

TEST(FusePiece, SphereIsClosedAndInItsPlace) {
  base::ThreadPool threads(2);
  const test::Pictures pictures = Around(kBall, 30, false);
  const Mesh mesh = FusePiece(pictures.views, Cube(32), BallOptions(), threads);
  const test::MeshCheck check = test::CheckMesh(mesh);
  EXPECT_EQ(check.boundary_edges, 0);
  EXPECT_EQ(check.bad_edges, 0);
  EXPECT_TRUE(check.bad_vertices.empty());
  EXPECT_EQ(check.degenerate, 0);
  // Of a sphere of 20 voxels, a pixel of 1.3 voxels sees up to 0.15 voxels beside the plane through its middle where it is steep, and the edges of a
  // cell cut off up to 0.05.
  EXPECT_LT(LargestError(kBall, mesh), 0.25 * kVoxel);
  EXPECT_LT(MeanError(kBall, mesh), 0.06 * kVoxel);
  // A mesh that is turned over has a negative volume.
  EXPECT_NEAR(test::SignedVolume(mesh), 4.0 / 3.0 * std::numbers::pi * 1000.0, 40.0);
  ASSERT_EQ(mesh.key.size(), mesh.position.size());
  ASSERT_EQ(mesh.views.size(), mesh.position.size());
  EXPECT_EQ(mesh.filled, std::vector<uint8_t>(mesh.position.size(), 0));
}

TEST(FusePiece, SlantedPlaneIsExact) {
  base::ThreadPool threads(2);
  const test::AnalyticScene scene{.planes = {{{0, 0, 0.3}, {0.3, -0.2, 1.0}}}, .spheres = {}, .boxes = {}};
  const test::Pictures pictures = Around(scene, 12, true);
  const Mesh mesh = FusePiece(pictures.views, Cube(24), BallOptions(), threads);
  ASSERT_GT(mesh.triangle.size(), 2000U);
  EXPECT_EQ(test::CheckMesh(mesh).bad_edges, 0);
  // Distances to the tangent plane are exact for a plane, up to floats and the rounding of the cosine; the interpolation of depth bends it by less
  // than a hundredth of a voxel.
  EXPECT_LT(LargestError(scene, mesh), 0.05 * kVoxel);
  for (const Triangle& t : mesh.triangle) {
    const Eigen::Vector3d a = mesh.position[t[0]], b = mesh.position[t[1]], c = mesh.position[t[2]];
    ASSERT_GT((b - a).cross(c - a).dot(scene.planes[0].normal), 0.0);
  }
}

TEST(FusePiece, WallsThatAreOnlySeenFlatAreComplete) {
  base::ThreadPool threads(2);
  const test::AnalyticScene scene{.planes = {{{0, 0, -8}, {0, 0, 1}}}, .spheres = {}, .boxes = {{{-5.2, -4.1, -8}, {6.3, 5.4, 3.7}}}};
  const test::Pictures pictures = Around(scene, 24, true);
  const Mesh mesh = FusePiece(pictures.views, Cube(24), BallOptions(), threads);
  EXPECT_EQ(test::CheckMesh(mesh).bad_edges, 0);
  // Edges of the box are rounded, where the planes of its sides and its roof are averaged; its foot too.
  EXPECT_LT(LargestError(scene, mesh), 2.0 * kVoxel);
  EXPECT_LT(MeanError(scene, mesh), 0.1 * kVoxel);
  // Away from them flat pixels reach 2.6 m along the walls. A view that looks along a wall must not hollow it out where its pixels are half beside
  // it.
  for (const Eigen::Vector3d& x : mesh.position) {
    if (x.z() > 1.7 || x.z() < -6.0 || std::abs(x.y()) > 2.1) continue;
    ASSERT_LT(scene.Distance(x), 0.3 * kVoxel) << x.transpose();
  }
  // Between roof and ground each wall has its share of vertices.
  size_t n_wall = 0;
  for (const Eigen::Vector3d& x : mesh.position) n_wall += std::abs(x.x() - 6.3) < kVoxel && std::abs(x.y()) < 2.0 && std::abs(x.z()) < 1.0 ? 1 : 0;
  EXPECT_GT(n_wall, 25U);
}

// A plane from straight above. The last n_left pictures have only their left halves; the pictures' right is south.
test::Pictures PlaneSeenBy(int n_both, int n_left, int photos) {
  const test::AnalyticScene scene{.planes = {{{0, 0, 0.1}, {0, 0, 1}}}, .spheres = {}, .boxes = {}};
  test::Pictures pictures;
  for (int i = 0; i < n_both + n_left; ++i) pictures.Add(scene, {0.1 * i, 0, 40}, {0.1 * i, 0, 0}, 52.0, 64, i < photos ? i : -1);
  for (int i = n_both; i < n_both + n_left; ++i) {
    for (size_t pixel = 0; pixel < 64 * 64; ++pixel) {
      if (pixel % 64 >= 32) pictures.depth_m[static_cast<size_t>(i)][pixel] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return pictures;
}

double ReachToTheRight(const Mesh& mesh) {
  double largest = -1e9;
  for (const Eigen::Vector3d& x : mesh.position) largest = std::max(largest, -x.y());
  return largest;
}

TEST(FusePiece, DropsWhatTooFewViewsSaw) {
  base::ThreadPool threads(1);
  EXPECT_GT(ReachToTheRight(FusePiece(PlaneSeenBy(3, 2, 5).views, Cube(16), BallOptions(), threads)), 7.0);
  EXPECT_LT(ReachToTheRight(FusePiece(PlaneSeenBy(2, 2, 4).views, Cube(16), BallOptions(), threads)), 2.0);
  EXPECT_TRUE(FusePiece(PlaneSeenBy(2, 0, 2).views, Cube(16), BallOptions(), threads).triangle.empty());
}

TEST(FusePiece, DropsWhatTooFewPhotosSaw) {
  base::ThreadPool threads(1);
  FuseOptions options = BallOptions();
  options.min_photos = 2;
  EXPECT_TRUE(FusePiece(PlaneSeenBy(6, 0, 1).views, Cube(16), options, threads).triangle.empty());
  const Mesh mesh = FusePiece(PlaneSeenBy(6, 0, 2).views, Cube(16), options, threads);
  ASSERT_FALSE(mesh.triangle.empty());
  EXPECT_EQ(*std::max_element(mesh.views.begin(), mesh.views.end()), 6);
}

TEST(FusePiece, RaysThatMeetNothingDropWhatStandsInTheirWay) {
  base::ThreadPool threads(1);
  // Three pictures show a plane, five others nothing, or they do not know.
  const auto fused = [&threads](uint8_t cosine) {
    test::Pictures pictures = PlaneSeenBy(8, 0, 8);
    for (size_t i = 3; i < 8; ++i) {
      for (size_t pixel = 0; pixel < 64 * 64; ++pixel) {
        if (pixel % 64 < 32) continue;
        pictures.depth_m[i][pixel] = std::numeric_limits<float>::quiet_NaN();
        pictures.cosine[i][pixel] = cosine;
      }
    }
    return FusePiece(pictures.views, Cube(16), BallOptions(), threads);
  };
  EXPECT_GT(ReachToTheRight(fused(0)), 7.0);
  const Mesh open = fused(kMeetsNothing);
  EXPECT_LT(ReachToTheRight(open), 2.0);
  ASSERT_FALSE(open.triangle.empty()) << "the other half stays";
  for (const Eigen::Vector3d& x : open.position) {
    if (x.y() > 1.0) EXPECT_NEAR(x.z(), 0.1, 0.05);
  }
}

TEST(FusePiece, DepthsCountByTheirWeight) {
  base::ThreadPool threads(2);
  // Four pictures of a plane at 0.1 m and four that see it half a voxel lower.
  test::Pictures pictures = PlaneSeenBy(8, 0, 8);
  for (size_t i = 4; i < 8; ++i) {
    for (float& depth : pictures.depth_m[i]) depth += static_cast<float>(0.5 * kVoxel);
  }
  const auto height = [&](uint8_t weight) {
    const std::vector<uint8_t> less(pictures.depth_m[0].size(), weight);
    std::vector<DepthView> views = pictures.views;
    for (size_t i = 4; i < 8; ++i) views[i].weight = less;
    const Mesh mesh = FusePiece(views, Cube(8), BallOptions(), threads);
    double sum = 0.0;
    for (const Eigen::Vector3d& x : mesh.position) sum += x.z();
    return sum / static_cast<double>(mesh.position.size());
  };
  EXPECT_NEAR(height(kFullWeight), 0.1 - 0.25 * kVoxel, 0.03 * kVoxel);
  EXPECT_NEAR(height(51), 0.1 - 0.5 * kVoxel / 6.0, 0.03 * kVoxel);  // a fifth
  EXPECT_NEAR(height(0), 0.1, 0.01 * kVoxel);
}

TEST(FusePiece, ConfirmedDepthsStandForTwoViews) {
  base::ThreadPool threads(2);
  const test::Pictures pictures = PlaneSeenBy(2, 0, 2);  // three views are asked for
  const std::vector<uint8_t> confirmed(pictures.depth_m[0].size(), kConfirmedWeight), full(confirmed.size(), kFullWeight);
  std::vector<DepthView> views = pictures.views;
  for (DepthView& view : views) view.weight = full;
  EXPECT_TRUE(FusePiece(views, Cube(16), BallOptions(), threads).triangle.empty());
  views[1].weight = confirmed;
  EXPECT_FALSE(FusePiece(views, Cube(16), BallOptions(), threads).triangle.empty());
}

TEST(FusePiece, NothingFromNothing) {
  base::ThreadPool threads(2);
  EXPECT_TRUE(FusePiece(std::span<const DepthView>(), Cube(16), BallOptions(), threads).position.empty());
  test::Pictures pictures = PlaneSeenBy(4, 0, 4);
  EXPECT_TRUE(FusePiece(pictures.views, {{0, 0, 0}, {8, 0, 8}}, BallOptions(), threads).position.empty());
  // Elsewhere.
  EXPECT_TRUE(FusePiece(pictures.views, {{100, 100, 100}, {120, 120, 120}}, BallOptions(), threads).position.empty());
  // Depths that are none.
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -3.0F, 0.0F};
  for (std::vector<float>& depth : pictures.depth_m) {
    for (size_t i = 0; i < depth.size(); ++i) depth[i] = bad[i % 4];
  }
  EXPECT_TRUE(FusePiece(pictures.views, Cube(16), BallOptions(), threads).position.empty());
  // Pictures without pixels, of one pixel, and of a pose that is none.
  ViewPose pose = pictures.views[0].pose;
  const float depth = 40.0F;
  const uint8_t cosine = 255;
  pose.width = pose.height = 1;
  std::vector<DepthView> odd(4, DepthView{pose, {&depth, 1}, {&cosine, 1}});
  odd[0] = DepthView{};
  odd[1].pose.cam_from_enu.translation.x() = std::numeric_limits<double>::quiet_NaN();
  const Mesh mesh = FusePiece(odd, Cube(16), BallOptions(), threads);
  EXPECT_EQ(test::CheckMesh(mesh).bad_edges, 0);
}

TEST(FusePiece, HolesOfOnePictureAreClosedByOthers) {
  base::ThreadPool threads(2);
  test::Pictures pictures = Around(kBall, 30, false);
  for (size_t view = 0; view < pictures.depth_m.size(); ++view) {
    for (size_t i = view; i < pictures.depth_m[view].size(); i += 5) pictures.depth_m[view][i] = std::numeric_limits<float>::quiet_NaN();
  }
  const Mesh mesh = FusePiece(pictures.views, Cube(32), BallOptions(), threads);
  EXPECT_EQ(test::CheckMesh(mesh).boundary_edges, 0);
  // Beside a missing pixel the nearest one stands for places up to 0.7 voxels away, at any angle.
  EXPECT_LT(LargestError(kBall, mesh), 0.6 * kVoxel);
}

TEST(FusePiece, SameBitsForAnyNumberOfThreads) {
  const test::Pictures pictures = Around(kBall, 10, false);
  base::ThreadPool one(1), four(4);
  const Mesh a = FusePiece(pictures.views, Cube(32), BallOptions(), one);
  const Mesh b = FusePiece(pictures.views, Cube(32), BallOptions(), four);
  ASSERT_FALSE(a.triangle.empty());
  EXPECT_EQ(a.triangle, b.triangle);
  EXPECT_EQ(a.key, b.key);
  EXPECT_EQ(a.views, b.views);
  ASSERT_EQ(a.position.size(), b.position.size());
  EXPECT_EQ(std::memcmp(a.position.data(), b.position.data(), a.position.size() * sizeof(Eigen::Vector3d)), 0);
}

}  // namespace
}  // namespace skyquilt::surface
