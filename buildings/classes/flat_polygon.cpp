#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "buildings/classes/model_parts.h"

namespace skyquilt::buildings {
namespace {

double SquaredDistance(const Eigen::Vector2d& x, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((x - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (x - a - t * along).squaredNorm();
}

bool Crosses(const Eigen::Vector2d& x, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  if ((a.y() > x.y()) == (b.y() > x.y())) return false;
  return x.x() < a.x() + (b.x() - a.x()) * (x.y() - a.y()) / (b.y() - a.y());
}

}  // namespace

FlatPolygon::FlatPolygon(std::vector<std::vector<Eigen::Vector3d>> rings, const Eigen::Vector3d& normal)
    : rings_(std::move(rings)), origin_(rings_[0][0]), normal_(normal), axis_s_(normal.unitOrthogonal()), axis_t_(normal.cross(axis_s_)) {
  for (const auto& ring : rings_) {
    auto& flat = flat_.emplace_back();
    for (const Eigen::Vector3d& x : ring) flat.emplace_back((x - origin_).dot(axis_s_), (x - origin_).dot(axis_t_));
  }
}

double FlatPolygon::Distance(const Eigen::Vector3d& x, double reach) const {
  const double height = (x - origin_).dot(normal_);
  if (std::abs(height) > reach) return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d place((x - origin_).dot(axis_s_), (x - origin_).dot(axis_t_));
  bool inside = false;
  double nearest2 = std::numeric_limits<double>::infinity();
  for (const auto& ring : flat_) {
    for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      if (Crosses(place, ring[i], ring[j])) inside = !inside;
      nearest2 = std::min(nearest2, SquaredDistance(place, ring[i], ring[j]));
    }
  }
  return inside ? std::abs(height) : std::sqrt(nearest2 + height * height);
}

double DistanceToSegment(const Eigen::Vector3d& x, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((x - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (x - a - t * along).norm();
}

}  // namespace skyquilt::buildings
