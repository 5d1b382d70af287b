#include "core/camera/distortion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/linear/linear.h"

namespace skyquilt::camera {
namespace {

constexpr int kNewtonSteps = 20;
// In units of the plane z = 1: 1e-13 of a focal length, far below a millionth of a pixel.
constexpr double kTolerance = 1e-13;
// A ray 89.4 degrees off the axis; perspective models are meaningless beyond.
constexpr double kMaxPlaneRadius = 100.0;
// Real lenses fold far outside the image; up to this radius only the end point is checked, not the radii before it.
constexpr double kUncheckedRadius = 0.5;
constexpr int kGrowthSamples = 8;
constexpr double kScanStep = 0.01;

}  // namespace

Distortion::Jet Distortion::RadialFactor(double s) const {
  const double numerator = 1.0 + s * (k_[0] + s * (k_[1] + s * k_[2]));
  const double numerator_slope = k_[0] + s * (2.0 * k_[1] + s * 3.0 * k_[2]);
  const double denominator = 1.0 + s * (k_[3] + s * (k_[4] + s * k_[5]));
  const double denominator_slope = k_[3] + s * (2.0 * k_[4] + s * 3.0 * k_[5]);
  const double factor = numerator / denominator;
  return {factor, (numerator_slope - factor * denominator_slope) / denominator};
}

Distortion::Jet Distortion::Profile(double r) const {
  const double s = r * r;
  if (is_fisheye_) {
    return {r * (1.0 + s * (k_[0] + s * (k_[1] + s * (k_[2] + s * k_[3])))),
            1.0 + s * (3.0 * k_[0] + s * (5.0 * k_[1] + s * (7.0 * k_[2] + s * 9.0 * k_[3])))};
  }
  const Jet factor = RadialFactor(s);
  return {r * factor.value, factor.value + 2.0 * s * factor.slope};
}

bool Distortion::GrowsUpTo(double r) const {
  const Jet end = Profile(r);
  // A pole of the rational model changes the sign of the value.
  if (!(end.slope > 0.0) || !(end.value >= 0.0)) return false;
  if (r <= kUncheckedRadius) return true;
  for (int i = 1; i < kGrowthSamples; ++i) {
    const Jet between = Profile(r * i / kGrowthSamples);
    if (!(between.slope > 0.0) || !(between.value <= end.value)) return false;
  }
  return true;
}

double Distortion::InvertProfile(double distorted_radius) const {
  const double limit = is_fisheye_ ? std::numbers::pi : kMaxPlaneRadius;
  double r = std::min(distorted_radius, limit);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Jet at = Profile(r);
    const double residual = at.value - distorted_radius;
    if (std::abs(residual) <= kTolerance * (1.0 + distorted_radius)) {
      if (GrowsUpTo(r)) return r;
      break;
    }
    const double next = r - residual / at.slope;
    if (!(at.slope > 0.0) || !(next >= 0.0) || !(next <= limit)) break;
    r = next;
  }
  return InvertProfileSlowly(distorted_radius);
}

double Distortion::InvertProfileSlowly(double distorted_radius) const {
  const double limit = is_fisheye_ ? std::numbers::pi : kMaxPlaneRadius;
  // Scans from the centre to the first radius that is large enough or past the fold, then bisects the last step.
  const auto is_beyond = [&](double r) {
    const Jet at = Profile(r);
    return !(at.slope > 0.0) || !(at.value >= 0.0) || !(at.value < distorted_radius);
  };
  double low = 0.0;
  double high = 0.0;
  while (high < limit) {
    // Steps grow with the radius: only folds near the axis need fine ones.
    high = std::min(limit, low + kScanStep * (1.0 + low));
    if (is_beyond(high)) break;
    low = high;
  }
  for (int step = 0; step < 60 && low < high; ++step) {
    const double middle = 0.5 * (low + high);
    (is_beyond(middle) ? high : low) = middle;
  }
  return low;
}

Eigen::Vector2d Distortion::DistortPlane(const Eigen::Vector2d& ideal, Eigen::Matrix2d* jacobian) const {
  const double u = ideal.x();
  const double v = ideal.y();
  const double s = ideal.squaredNorm();
  const Jet factor = RadialFactor(s);
  if (jacobian != nullptr) {
    const double cross = 2.0 * (u * v * factor.slope + p1_ * u + p2_ * v);
    (*jacobian)(0, 0) = factor.value + 2.0 * u * u * factor.slope + 2.0 * p1_ * v + 6.0 * p2_ * u;
    (*jacobian)(0, 1) = cross;
    (*jacobian)(1, 0) = cross;
    (*jacobian)(1, 1) = factor.value + 2.0 * v * v * factor.slope + 2.0 * p2_ * u + 6.0 * p1_ * v;
  }
  return {u * factor.value + 2.0 * p1_ * u * v + p2_ * (s + 2.0 * u * u), v * factor.value + 2.0 * p2_ * u * v + p1_ * (s + 2.0 * v * v)};
}

std::optional<Eigen::Vector2d> Distortion::Distort(const Eigen::Vector3d& direction) const {
  const Eigen::Vector2d ideal = direction.head<2>() / direction.z();
  if (is_ideal_) return ideal;
  if (is_fisheye_) {
    const double r = ideal.norm();
    const double theta = std::atan(r);
    if (!GrowsUpTo(theta)) return std::nullopt;
    // theta_d / r tends to 1 at the centre.
    return r > 1e-12 ? Eigen::Vector2d(ideal * (Profile(theta).value / r)) : ideal;
  }
  if (!GrowsUpTo(ideal.norm())) return std::nullopt;
  Eigen::Matrix2d jacobian;
  const Eigen::Vector2d distorted = DistortPlane(ideal, &jacobian);
  if (!(linear::Determinant(jacobian) > 0.0)) return std::nullopt;
  return distorted;
}

Eigen::Vector2d Distortion::UndistortPlane(const Eigen::Vector2d& distorted) const {
  const double distorted_radius = distorted.stableNorm();
  if (distorted_radius < 1e-300) return distorted;
  // Start from the inverse of the radial part, which is safe in one dimension; the tangential part is a small correction.
  Eigen::Vector2d ideal = distorted * (InvertProfile(distorted_radius) / distorted_radius);
  if (p1_ == 0.0 && p2_ == 0.0) return ideal;

  Eigen::Matrix2d jacobian;
  Eigen::Vector2d residual = DistortPlane(ideal, &jacobian) - distorted;
  for (int step = 0; step < kNewtonSteps && residual.norm() > kTolerance * (1.0 + distorted_radius); ++step) {
    // Near a fold the Newton direction is unreliable; the residual itself (a fixed-point step) is safer.
    const bool is_regular = linear::Determinant(jacobian) > 1e-6;
    const Eigen::Vector2d direction = is_regular ? Eigen::Vector2d(linear::Inverse(jacobian) * residual) : residual;
    bool improved = false;
    for (double length = 1.0; length > 1e-4 && !improved; length *= 0.5) {
      const Eigen::Vector2d candidate = ideal - length * direction;
      Eigen::Matrix2d candidate_jacobian;
      const Eigen::Vector2d candidate_residual = DistortPlane(candidate, &candidate_jacobian) - distorted;
      if (!(candidate_residual.norm() < residual.norm()) || !GrowsUpTo(candidate.norm())) continue;
      ideal = candidate;
      residual = candidate_residual;
      jacobian = candidate_jacobian;
      improved = true;
    }
    if (!improved) break;
  }
  return ideal;
}

Eigen::Vector3d Distortion::Undistort(const Eigen::Vector2d& distorted) const {
  if (!distorted.allFinite()) return Eigen::Vector3d::UnitZ();
  if (is_fisheye_) {
    const double distorted_radius = distorted.stableNorm();
    if (distorted_radius < 1e-300) return Eigen::Vector3d::UnitZ();
    const double theta = InvertProfile(distorted_radius);
    const Eigen::Vector2d across = distorted * (std::sin(theta) / distorted_radius);
    return {across.x(), across.y(), std::cos(theta)};
  }
  // stableNormalized: for far-off pixels the squared coordinates may overflow.
  return (is_ideal_ ? distorted : UndistortPlane(distorted)).homogeneous().stableNormalized();
}

}  // namespace skyquilt::camera
