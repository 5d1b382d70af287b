#include "core/scene/depth_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/errors.h"
#include "core/linear/linear.h"

namespace skyquilt::scene {

using Eigen::Vector3d;

image::ImageF NormalsOfDepth(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const image::ImageF& z_depth,
                             const DepthNormalOptions& options, base::ThreadPool& threads) {
  SKYQUILT_CHECK(z_depth.width == camera.width && z_depth.height == camera.height && z_depth.channels == 1,
                 "the depth must have the size of the camera's image");
  SKYQUILT_CHECK(options.radius_px >= 1, "a plane needs neighbours");
  const int width = camera.width, height = camera.height, radius = options.radius_px;
  image::ImageF normals(width, height, 3, std::numeric_limits<float>::quiet_NaN());
  std::vector<Vector3d> surface(z_depth.data.size());  // camera frame
  threads.ParallelFor(height, [&](int64_t row, int) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      const double z = static_cast<double>(*z_depth.At(x, y));
      const Vector3d ray = camera.RayFromImg({x + 0.5, y + 0.5});
      surface[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] =
          ray.z() > 0.0 ? Vector3d(ray * (z / ray.z())) : Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    }
  });
  const double max_slope = std::tan(options.max_tilt_deg * std::numbers::pi / 180.0);
  const Eigen::Matrix3d enu_from_cam = cam_from_enu.rotation.conjugate().toRotationMatrix();
  threads.ParallelFor(height, [&](int64_t row, int) {
    const int y = static_cast<int>(row);
    std::vector<Vector3d> points;
    for (int x = 0; x < width; ++x) {
      const Vector3d middle = surface[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
      if (!middle.allFinite()) continue;
      const Vector3d towards = -middle.normalized();
      points.clear();
      Vector3d mean = Vector3d::Zero();
      int neighbours = 0;
      for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v) {
        for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u) {
          ++neighbours;
          const Vector3d& point = surface[static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u)];
          if (!point.allFinite()) continue;
          const Vector3d step = point - middle;
          const double along = step.dot(towards);
          if (std::abs(along) > max_slope * (step - along * towards).norm()) continue;
          points.push_back(point);
          mean += point;
        }
      }
      if (points.size() < 3 || 2 * points.size() < static_cast<size_t>(neighbours)) continue;
      mean /= static_cast<double>(points.size());
      Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
      for (const Vector3d& point : points) spread += (point - mean) * (point - mean).transpose();
      const linear::EigenPairs<3> eigen = linear::FastSymmetricEigen(spread);
      Vector3d normal = eigen.vectors.col(0);
      // Points on a line fit many planes.
      if (!(eigen.values[1] > 1e-9 * eigen.values[2])) continue;
      if (normal.dot(towards) < 0.0) normal = -normal;
      const Vector3d in_enu = enu_from_cam * normal;
      for (Eigen::Index c = 0; c < 3; ++c) normals.At(x, y)[c] = static_cast<float>(in_enu[c]);
    }
  });
  return normals;
}

}  // namespace skyquilt::scene
