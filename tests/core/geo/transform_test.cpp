#include "core/geo/transform.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"

namespace skyquilt::geo {
namespace {

Eigen::Vector3d RandomVector(base::Random& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

Eigen::Quaterniond RandomRotation(base::Random& random) {
  return Eigen::Quaterniond{random.Normal(), random.Normal(), random.Normal(), random.Normal()}.normalized();
}

TEST(Rigid3d, InverseUndoes) {
  base::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Rigid3d cam_from_world{RandomRotation(random), RandomVector(random, 1000.0)};
    const Eigen::Vector3d x = RandomVector(random, 1000.0);
    EXPECT_LT((cam_from_world.Inverse() * (cam_from_world * x) - x).norm(), 1e-9);
    EXPECT_LT((cam_from_world * cam_from_world.OriginInSource()).norm(), 1e-9);
  }
}

TEST(TransformCameraWorld, SameCameraSeesTheSamePoint) {
  base::Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Rigid3d cam_from_a{RandomRotation(random), RandomVector(random, 10.0)};
    const Similarity3d b_from_a{std::exp(random.Uniform(-3.0, 3.0)), RandomRotation(random), RandomVector(random, 1000.0)};
    const Rigid3d cam_from_b = TransformCameraWorld(cam_from_a, b_from_a);
    const Eigen::Vector3d x_in_a = RandomVector(random, 10.0);
    // The camera frame itself becomes metric: same direction, distance times the scale.
    EXPECT_LT((cam_from_b * (b_from_a * x_in_a) - b_from_a.scale * (cam_from_a * x_in_a)).norm(), 1e-9);
    EXPECT_LT((cam_from_b.OriginInSource() - b_from_a * cam_from_a.OriginInSource()).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace skyquilt::geo
