#include "core/survey/seen_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/order_statistics.h"

namespace skyquilt::survey {
namespace {

constexpr size_t kEnoughPoints = 20;
constexpr double kStrayShare = 0.005;  // of the points, beyond each side of the area
constexpr double kRimShare = 0.03;     // of the area's size, added on each side: the ground goes on where points end

std::array<double, 2> RangeOfPoints(const std::vector<Eigen::Vector3d>& points, int axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& point : points) values.push_back(point[axis]);
  const double low = base::NearestRankQuantile(values, kStrayShare);
  return {low, base::NearestRankQuantile(values, 1.0 - kStrayShare)};
}

// Where the rays of the photo's rim meet the level ground, or come as near to it as the widest view allows.
void ExtendByPhoto(const Photo& photo, const camera::Camera& camera, double ground_z, Eigen::AlignedBox2d* area) {
  const double widest = std::tan(kWidestView_deg * std::numbers::pi / 180.0);
  const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
  const double height = eye.z() - ground_z;
  if (!eye.allFinite() || !(height > 0.0)) return;
  Eigen::AlignedBox2d seen;
  bool down = false;
  for (const double u : {0.0, 0.5, 1.0}) {
    for (const double v : {0.0, 0.5, 1.0}) {
      const Eigen::Vector3d ray = photo.cam_from_enu.rotation.conjugate() * camera.RayFromImg({u * camera.width, v * camera.height});
      const double across = ray.head<2>().norm();
      const bool steep = ray.z() < 0.0 && across <= widest * -ray.z();
      down = down || steep;
      const Eigen::Vector2d reach = ray.head<2>() * (steep ? 1.0 / -ray.z() : widest / std::max(across, 1e-12));
      seen.extend(eye.head<2>() + height * reach);
    }
  }
  if (down) area->extend(seen);
}

}  // namespace

std::vector<Eigen::Vector3d> SteadyPoints(const Survey& survey) {
  std::vector<Eigen::Vector3d> all, steady;
  for (const SparsePoint& point : survey.points) {
    if (!point.x_in_enu.allFinite()) continue;
    all.push_back(point.x_in_enu);
    if (point.track_length >= 3) steady.push_back(point.x_in_enu);
  }
  return steady.size() >= std::max(kEnoughPoints, all.size() / 4) ? steady : all;
}

Eigen::AlignedBox2d SeenGround(const Survey& survey, const std::vector<Eigen::Vector3d>& points, double ground_z) {
  Eigen::AlignedBox2d area;
  for (const Photo& photo : survey.photos) ExtendByPhoto(photo, survey.cameras[static_cast<size_t>(photo.camera)], ground_z, &area);
  if (area.isEmpty() || points.size() < kEnoughPoints) return area;
  Eigen::AlignedBox2d known;
  const auto [west, east] = RangeOfPoints(points, 0);
  const auto [south, north] = RangeOfPoints(points, 1);
  const Eigen::Vector2d rim = kRimShare * Eigen::Vector2d(east - west, north - south);
  known.extend(Eigen::Vector2d(west, south) - rim);
  known.extend(Eigen::Vector2d(east, north) + rim);
  const Eigen::AlignedBox2d both = area.intersection(known);
  return both.isEmpty() || !(both.sizes().minCoeff() > 0.0) ? area : both;
}

}  // namespace skyquilt::survey
