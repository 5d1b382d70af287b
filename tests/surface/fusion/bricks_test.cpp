#include "surface/fusion/bricks.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/base/random.h"
#include "tests/surface/fusion/analytic_views.h"

namespace skyquilt::surface {
namespace {

FuseOptions BrickOptions() {
  FuseOptions options;
  options.voxel_m = 0.4;
  return options;
}

// A view of slanted ground from close by, so that boxes around the camera, beside the image and behind the camera occur.
test::Pictures Close(base::Random* random) {
  const test::AnalyticScene scene{.planes = {{{0, 0, -3}, {0.5, 0.1, 1.0}}}, .spheres = {}, .boxes = {}};
  test::Pictures pictures;
  const Eigen::Vector3d from{random->Uniform(-4, 4), random->Uniform(-4, 4), 6};
  pictures.Add(scene, from, {random->Uniform(-9, 9), random->Uniform(-9, 9), -3}, 30.0, 40, 0);
  return pictures;
}

bool Holds(const LatticeBox& box, const Eigen::Vector3i& brick) {
  return (brick.array() >= box.min.array()).all() && (brick.array() < box.max.array()).all();
}

RC_GTEST_PROP(MarkBricks, DoesNotDependOnTheRange, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  const test::Pictures pictures = Close(&random);
  const LatticeBox everywhere{{-40, -40, -40}, {40, 40, 40}};
  const std::vector<ViewCamera> cameras = CamerasThatSee(pictures.views, ReachOfBricks(everywhere, BrickOptions().voxel_m));
  RC_ASSERT(cameras.size() == 1U);
  const std::vector<uint64_t> all = MarkBricks(cameras[0], everywhere, BrickOptions());
  RC_ASSERT(!all.empty());
  RC_ASSERT(std::is_sorted(all.begin(), all.end()));
  for (int repeat = 0; repeat < 20; ++repeat) {
    const Eigen::Vector3i low(*rc::gen::inRange(-6, 6), *rc::gen::inRange(-6, 6), *rc::gen::inRange(-5, 1));
    const Eigen::Vector3i size(*rc::gen::inRange(1, 4), *rc::gen::inRange(1, 4), *rc::gen::inRange(1, 4));
    const LatticeBox range{low, low + size};
    std::vector<uint64_t> expected;
    std::copy_if(all.begin(), all.end(), std::back_inserter(expected), [&](uint64_t key) { return Holds(range, BrickOfKey(key)); });
    RC_ASSERT(MarkBricks(cameras[0], range, BrickOptions()) == expected);
    // A view that marks something is not left out.
    const bool kept = !CamerasThatSee(pictures.views, ReachOfBricks(range, BrickOptions().voxel_m)).empty();
    RC_ASSERT(kept || expected.empty());
  }
}

TEST(MarkBricks, HoldTheCellsAroundEachSurfacePoint) {
  base::Random random(3);
  const test::Pictures pictures = Close(&random);
  const LatticeBox everywhere{{-40, -40, -40}, {40, 40, 40}};
  base::ThreadPool threads(2);
  const std::vector<ViewCamera> cameras = CamerasThatSee(pictures.views, ReachOfBricks(everywhere, BrickOptions().voxel_m));
  const Bricks bricks = MarkAllBricks(cameras, everywhere, BrickOptions(), threads);
  const ViewPose& pose = pictures.views[0].pose;
  for (int y = 0; y < pose.height; ++y) {
    for (int x = 0; x < pose.width; ++x) {
      const float depth = pictures.depth_m[0][static_cast<size_t>(y * pose.width + x)];
      if (!IsDepth(depth)) continue;
      for (const double offset : {-4.0, -2.3, 0.0, 1.1, 4.0}) {
        const double t_m = static_cast<double>(depth) + offset * BrickOptions().voxel_m;
        const Eigen::Vector3d point = (pose.Centre() + t_m * pose.DirectionAt(x + 0.5, y + 0.5)) / BrickOptions().voxel_m;
        for (int corner = 0; corner < 8; ++corner) {
          const Eigen::Vector3i node = point.array().floor().cast<int>().matrix() + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
          ASSERT_GE(bricks.Find({BrickOfNode(node.x()), BrickOfNode(node.y()), BrickOfNode(node.z())}), 0);
        }
      }
    }
  }
}

TEST(BrickKey, RoundTripsAndSortsByHeight) {
  for (const Eigen::Vector3i& brick : {Eigen::Vector3i(0, 0, 0), Eigen::Vector3i(-1, 5, -7), Eigen::Vector3i(-65536, 65535, -16384)}) {
    EXPECT_EQ(BrickOfKey(BrickKey(brick.x(), brick.y(), brick.z())), brick);
  }
  EXPECT_LT(BrickKey(9, 9, -1), BrickKey(-9, -9, 0));
  EXPECT_EQ(BrickOfNode(-1), -1);
  EXPECT_EQ(BrickOfNode(-8), -1);
  EXPECT_EQ(BrickOfNode(-9), -2);
}

}  // namespace
}  // namespace skyquilt::surface
