#include "core/raytrace/traced_scene.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace skyquilt::raytrace {
namespace {

// Two triangles that form a square at this height; x and y in [-1, 1].
TracedScene Square(float z) {
  const std::vector<Eigen::Vector3f> position = {{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}};
  const std::vector<std::array<uint32_t, 3>> triangle = {{0, 1, 2}, {0, 2, 3}};
  return {position, triangle};
}

RayPacket OneRay(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
  RayPacket rays{};
  for (size_t lane = 0; lane < kPacket; ++lane) rays.valid[lane] = 0;
  rays.Set(3, origin, direction, 0.0F, 100.0F);
  return rays;
}

TEST(TracedScene, FindsTheNearestHitFromBothSides) {
  const TracedScene scene = Square(2.0F);
  for (const float side : {-1.0F, 1.0F}) {
    RayPacket rays = OneRay({0.25F, -0.5F, 2.0F + 5.0F * side}, {0.0F, 0.0F, -side});
    EXPECT_EQ(scene.Intersect(rays), 1U << 3);
    EXPECT_FLOAT_EQ(rays.t_far[3], 5.0F);
    EXPECT_EQ(rays.triangle[3], 0U);
    EXPECT_EQ(scene.Occluded(OneRay({0.25F, -0.5F, 2.0F + 5.0F * side}, {0.0F, 0.0F, -side})), 1U << 3);
  }
}

TEST(TracedScene, LeavesAMissAlone) {
  const TracedScene scene = Square(2.0F);
  RayPacket rays = OneRay({3.0F, 0.0F, 5.0F}, {0.0F, 0.0F, -1.0F});
  EXPECT_EQ(scene.Intersect(rays), 0U);
  EXPECT_EQ(rays.triangle[3], kNoTriangle);
  EXPECT_FLOAT_EQ(rays.t_far[3], 100.0F);
  EXPECT_EQ(scene.Occluded(rays), 0U);
}

TEST(TracedScene, WithoutTrianglesNothingIsHit) {
  const TracedScene scene({}, {});
  EXPECT_TRUE(scene.empty());
  RayPacket rays = OneRay({0.0F, 0.0F, 5.0F}, {0.0F, 0.0F, -1.0F});
  EXPECT_EQ(scene.Intersect(rays), 0U);
  EXPECT_EQ(scene.Occluded(rays), 0U);
}

// Embree allows only about a thousand devices, so scenes must share one.
TEST(TracedScene, TwoThousandLiveAtOnceMadeByTwoThreads) {
  std::vector<std::vector<TracedScene>> scenes(2);
  std::vector<std::thread> threads;
  threads.reserve(scenes.size());
  for (auto& own : scenes) {
    threads.emplace_back([&own] {
      for (int i = 0; i < 1000; ++i) own.push_back(Square(static_cast<float>(i)));
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& own : scenes) {
    for (size_t i = 0; i < own.size(); ++i) {
      RayPacket rays = OneRay({0.0F, 0.5F, static_cast<float>(i) + 1.0F}, {0.0F, 0.0F, -1.0F});
      ASSERT_EQ(own[i].Intersect(rays), 1U << 3);
      ASSERT_FLOAT_EQ(rays.t_far[3], 1.0F);
    }
  }
}

}  // namespace
}  // namespace skyquilt::raytrace
