#include "core/camera/equirectangular.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"

namespace skyquilt::camera {
namespace {

constexpr Equirectangular kSphere{2048, 1024};

TEST(Equirectangular, MiddleLooksAlongZAndTheRightQuarterAlongX) {
  EXPECT_TRUE(kSphere.RayFromImg({1024.0, 512.0}).isApprox(Eigen::Vector3d::UnitZ(), 1e-15));
  EXPECT_TRUE(kSphere.RayFromImg({1536.0, 512.0}).isApprox(Eigen::Vector3d::UnitX(), 1e-15));
  EXPECT_NEAR((kSphere.RayFromImg({300.0, 1024.0}) - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((kSphere.RayFromImg({300.0, 0.0}) + Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-15);
}

TEST(Equirectangular, PixelOfARayIsTheRaysPixel) {
  base::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double column = random.Uniform(0.0, 2048.0), row = random.Uniform(0.5, 1023.5);
    const Eigen::Vector3d ray = kSphere.RayFromImg({column, row});
    EXPECT_NEAR(ray.norm(), 1.0, 1e-14);
    EXPECT_NEAR((kSphere.ImgFromRay(3.0 * ray) - Eigen::Vector2d(column, row)).norm(), 0.0, 1e-8);
  }
}

TEST(Equirectangular, ColumnsAreWithinThePictureAtItsSeamAndPoles) {
  for (const Eigen::Vector3d& ray : {Eigen::Vector3d(0.0, 0.0, -1.0), Eigen::Vector3d(-1e-300, 0.0, -1.0), Eigen::Vector3d(1e-300, 0.0, -1.0),
                                     Eigen::Vector3d(0.0, 1.0, 0.0), Eigen::Vector3d(0.0, -1.0, 0.0)}) {
    const Eigen::Vector2d pixel = kSphere.ImgFromRay(ray);
    EXPECT_GE(pixel.x(), 0.0);
    EXPECT_LT(pixel.x(), 2048.0);
    EXPECT_GE(pixel.y(), 0.0);
    EXPECT_LE(pixel.y(), 1024.0);
  }
}

}  // namespace
}  // namespace skyquilt::camera
