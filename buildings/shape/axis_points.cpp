#include "buildings/shape/axis_points.h"

#include <cmath>

namespace skyquilt::buildings {
namespace {

std::vector<Eigen::Vector2d> RingInAxes(const std::vector<Eigen::Vector2d>& ring, const Shape& axes) {
  std::vector<Eigen::Vector2d> uv;
  uv.reserve(ring.size());
  for (const Eigen::Vector2d& enu : ring) uv.push_back(axes.FromEnu(enu));
  return uv;
}

}  // namespace

AxisPoints InAxes(const Candidate& candidate, const PointCloud& cloud, const Shape& axes) {
  AxisPoints result;
  result.spacing_m = cloud.spacing_m;
  result.outline.outer = RingInAxes(candidate.outline.outer, axes);
  for (const auto& hole : candidate.outline.holes) result.outline.holes.push_back(RingInAxes(hole, axes));
  const Eigen::Vector2d u = axes.AxisU(), v = axes.AxisV();
  const auto turned = [&](uint32_t i) {
    const Eigen::Vector3d at = cloud.At(i), normal = cloud.points[i].normal.cast<double>();
    const Eigen::Vector2d uv = axes.FromEnu(at.head<2>());
    return AxisPoint{{uv.x(), uv.y(), at.z()}, {normal.head<2>().dot(u), normal.head<2>().dot(v), normal.z()}};
  };
  for (const uint32_t i : candidate.roof) {
    const AxisPoint point = turned(i);
    if (!point.at.allFinite() || !point.normal.allFinite()) continue;
    if (point.normal.z() > kRoofNormal) {
      result.roof.push_back(point);
    } else if (std::abs(point.normal.z()) < kWallNormal) {
      result.steep.push_back(point);
    }
  }
  for (const uint32_t i : candidate.wall) {
    const AxisPoint point = turned(i);
    if (point.at.allFinite() && point.normal.allFinite() && std::abs(point.normal.z()) < kWallNormal) result.steep.push_back(point);
  }
  return result;
}

}  // namespace skyquilt::buildings
