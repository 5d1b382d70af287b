#include "worker/planes/plane_fit.h"

#include <cmath>
#include <numbers>

#include "core/linear/linear.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

// Variances of the points along their three axes, smallest first: the second must be so many times the smallest, and such a share of the largest.
constexpr double kFlatness = 4.0, kBreadth = 1e-3;
// Upward components of the normals of planes that are nearly level (10 degrees) or vertical (20 degrees).
constexpr double kNearlyLevel = 0.985, kNearlyVertical = 0.35;
// Walls that are turned more against the buildings around them stay as they are.
constexpr double kNearlyAligned_deg = 10.0;
constexpr double kDegree = std::numbers::pi / 180.0;  // in radians

}  // namespace

std::optional<Plane> FitPlane(const std::vector<Vector3d>& points) {
  if (points.size() < kFewestPlanePoints) return std::nullopt;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& x : points) mean += x;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& x : points) spread += (x - mean) * (x - mean).transpose();
  if (!spread.allFinite()) return std::nullopt;
  const linear::EigenPairs<3> eigen = linear::SymmetricEigen(spread);
  const Vector3d& variance = eigen.values;
  if (!(variance[1] > kFlatness * variance[0] && variance[1] > kBreadth * variance[2])) return std::nullopt;
  return Plane{mean, eigen.vectors.col(0)};
}

std::optional<Plane> UprightPlane(const Plane& plane, std::optional<double> yaw_deg) {
  const double up = std::abs(plane.normal.z());
  if (up > kNearlyLevel) return Plane{plane.point, Vector3d::UnitZ()};
  if (!(up < kNearlyVertical)) return std::nullopt;
  const double normal_yaw = std::atan2(plane.normal.y(), plane.normal.x());
  const double turn = yaw_deg ? std::remainder(*yaw_deg * kDegree - normal_yaw, 0.5 * std::numbers::pi) : 0.0;
  const double yaw = std::abs(turn) < kNearlyAligned_deg * kDegree ? normal_yaw + turn : normal_yaw;
  return Plane{plane.point, Vector3d(std::cos(yaw), std::sin(yaw), 0.0)};
}

}  // namespace skyquilt::worker
