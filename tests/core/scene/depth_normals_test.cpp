#include "core/scene/depth_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace skyquilt::scene {
namespace {

using Eigen::Vector3d;

camera::Camera Pinhole() {
  return {camera::CameraModel::kPinhole, 40, 30, {50.0, 50.0, 20.0, 15.0}};
}

// Looks down from 100 m, turned about the vertical.
geo::Rigid3d Above() {
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(3.141592653589793, Vector3d::UnitX()));
  return {rotation, -(rotation * Vector3d(10.0, 20.0, 100.0))};
}

// z-depth of the plane normal . x = offset.
image::ImageF DepthOfPlane(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Vector3d& normal, double offset) {
  image::ImageF depth(camera.width, camera.height, 1);
  const geo::Rigid3d enu_from_cam = cam_from_enu.Inverse();
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vector3d ray = camera.RayFromImg({x + 0.5, y + 0.5});
      const Vector3d direction = enu_from_cam.rotation * ray;
      const double t = (offset - normal.dot(enu_from_cam.translation)) / normal.dot(direction);
      *depth.At(x, y) = static_cast<float>(t * ray.z());
    }
  }
  return depth;
}

TEST(DepthNormals, OfAPlaneAreItsNormal) {
  base::ThreadPool threads(2);
  for (const Vector3d& normal : {Vector3d(0, 0, 1), Vector3d(0.6, 0, 0.8), Vector3d(-0.4, 0.5, 0.6)}) {
    const Vector3d unit = normal.normalized();
    const image::ImageF normals = NormalsOfDepth(Pinhole(), Above(), DepthOfPlane(Pinhole(), Above(), unit, 1.0), {}, threads);
    for (int y = 0; y < normals.height; ++y) {
      for (int x = 0; x < normals.width; ++x) {
        const Eigen::Map<const Eigen::Vector3f> n(normals.At(x, y));
        EXPECT_GT(n.cast<double>().dot(unit), 0.9999) << x << " " << y;
      }
    }
  }
}

// A roof above the ground: pixels beside the step keep the normal of their own surface.
TEST(DepthNormals, DoNotBendAtAStep) {
  base::ThreadPool threads(1);
  const camera::Camera camera = Pinhole();
  image::ImageF depth = DepthOfPlane(camera, Above(), Vector3d::UnitZ(), 0.0);
  const image::ImageF roof = DepthOfPlane(camera, Above(), Vector3d::UnitZ(), 60.0);
  for (int y = 0; y < 30; ++y) {
    for (int x = 20; x < 40; ++x) *depth.At(x, y) = *roof.At(x, y);
  }
  const image::ImageF normals = NormalsOfDepth(camera, Above(), depth, {}, threads);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) EXPECT_GT(normals.At(x, y)[2], 0.999F) << x << " " << y;
  }
}

TEST(DepthNormals, WithoutDepthThereIsNone) {
  base::ThreadPool threads(1);
  const camera::Camera camera = Pinhole();
  image::ImageF depth(camera.width, camera.height, 1, std::numeric_limits<float>::quiet_NaN());
  *depth.At(5, 5) = 50.0F;
  const image::ImageF normals = NormalsOfDepth(camera, Above(), depth, {}, threads);
  for (const float value : normals.data) EXPECT_TRUE(std::isnan(value));
}

}  // namespace
}  // namespace skyquilt::scene
