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
  if (kind_ == Kind::kFisheye) {
    return {1.0 + s * (k_[0] + s * (k_[1] + s * (k_[2] + s * (k_[3] + s * (k_[4] + s * k_[5]))))),
            k_[0] + s * (2.0 * k_[1] + s * (3.0 * k_[2] + s * (4.0 * k_[3] + s * (5.0 * k_[4] + s * 6.0 * k_[5]))))};
  }
  if (kind_ == Kind::kFieldOfView) {
    if (is_ideal_) return {1.0, 0.0};
    const double a = 2.0 * std::tan(0.5 * k_[0]);
    const double b = a * a * s;
    // Series of atan(sqrt(b)) / sqrt(b): the slope is a difference of nearly equal numbers near the axis.
    if (b < 1e-4)
      return {a / k_[0] * (1.0 - b * (1.0 / 3.0 - b * (1.0 / 5.0 - b / 7.0))), a * a * a / k_[0] * (-1.0 / 3.0 + 2.0 * b / 5.0 - 3.0 * b * b / 7.0)};
    const Jet profile = Profile(std::sqrt(s));
    const double factor = profile.value / std::sqrt(s);
    return {factor, (profile.slope - factor) / (2.0 * s)};
  }
  const double numerator = 1.0 + s * (k_[0] + s * (k_[1] + s * k_[2]));
  const double numerator_slope = k_[0] + s * (2.0 * k_[1] + s * 3.0 * k_[2]);
  const double denominator = 1.0 + s * (k_[3] + s * (k_[4] + s * k_[5]));
  const double denominator_slope = k_[3] + s * (2.0 * k_[4] + s * 3.0 * k_[5]);
  const double factor = numerator / denominator;
  return {factor, (numerator_slope - factor * denominator_slope) / denominator};
}

Distortion::Jet Distortion::Profile(double r) const {
  const double s = r * r;
  if (kind_ == Kind::kFisheye) {
    return {r * (1.0 + s * (k_[0] + s * (k_[1] + s * (k_[2] + s * (k_[3] + s * (k_[4] + s * k_[5])))))),
            1.0 + s * (3.0 * k_[0] + s * (5.0 * k_[1] + s * (7.0 * k_[2] + (s * 9.0 * k_[3] + s * s * (11.0 * k_[4] + s * 13.0 * k_[5])))))};
  }
  if (kind_ == Kind::kFieldOfView) {
    if (is_ideal_) return {r, 1.0};
    const double a = 2.0 * std::tan(0.5 * k_[0]);
    return {std::atan(a * r) / k_[0], a / (k_[0] * (1.0 + a * a * s))};
  }
  const Jet factor = RadialFactor(s);
  return {r * factor.value, factor.value + 2.0 * s * factor.slope};
}

double Distortion::Limit() const {
  return kind_ == Kind::kFisheye ? std::numbers::pi : kMaxPlaneRadius;
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
  const double limit = Limit();
  if (kind_ == Kind::kFieldOfView) {
    const double angle = distorted_radius * std::abs(k_[0]);
    const double a = 2.0 * std::tan(0.5 * std::abs(k_[0]));
    if (!(a > 0.0)) return 0.0;
    return angle < std::atan(a * limit) ? std::tan(angle) / a : limit;
  }
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
  const double limit = Limit();
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

Eigen::Vector2d Distortion::WithShift(const Eigen::Vector2d& point, const Jet& factor, Eigen::Matrix2d* jacobian) const {
  const double u = point.x();
  const double v = point.y();
  const double s = point.squaredNorm();
  const auto& [p1, p2, prism, sequential] = shift_;
  if (jacobian != nullptr) {
    const double cross = 2.0 * (u * v * factor.slope + p1 * u + p2 * v);
    (*jacobian)(0, 0) = factor.value + 2.0 * u * u * factor.slope + 2.0 * p1 * v + 6.0 * p2 * u;
    (*jacobian)(0, 1) = cross;
    (*jacobian)(1, 0) = cross;
    (*jacobian)(1, 1) = factor.value + 2.0 * v * v * factor.slope + 2.0 * p2 * u + 6.0 * p1 * v;
  }
  Eigen::Vector2d distorted(u * factor.value + 2.0 * p1 * u * v + p2 * (s + 2.0 * u * u),
                            v * factor.value + 2.0 * p2 * u * v + p1 * (s + 2.0 * v * v));
  if (kind_ != Kind::kFisheye) return distorted;
  if (jacobian != nullptr) {
    const Eigen::Vector2d by_s(prism[0] + 2.0 * prism[1] * s, prism[2] + 2.0 * prism[3] * s);
    *jacobian += 2.0 * by_s * point.transpose();
  }
  return distorted + Eigen::Vector2d(s * (prism[0] + s * prism[1]), s * (prism[2] + s * prism[3]));
}

Eigen::Vector2d Distortion::DistortPlane(const Eigen::Vector2d& ideal, Eigen::Matrix2d* jacobian) const {
  const Jet factor = RadialFactor(ideal.squaredNorm());
  if (!shift_.sequential) return WithShift(ideal, factor, jacobian);
  const Eigen::Vector2d distorted = WithShift(ideal * factor.value, {1.0, 0.0}, jacobian);
  if (jacobian != nullptr) {
    const Eigen::Matrix2d radial = factor.value * Eigen::Matrix2d::Identity() + 2.0 * factor.slope * ideal * ideal.transpose();
    *jacobian = jacobian->lazyProduct(radial).eval();
  }
  return distorted;
}

std::optional<Eigen::Vector2d> Distortion::Distort(const Eigen::Vector3d& direction) const {
  Eigen::Vector2d ideal = direction.head<2>() / direction.z();
  if (is_ideal_) return ideal;
  const double tangent = ideal.norm();
  const double r = kind_ == Kind::kFisheye ? std::atan(tangent) : tangent;
  if (!GrowsUpTo(r)) return std::nullopt;
  if (kind_ != Kind::kPerspective && shift_.IsZero()) {
    // The quotient tends to a number at the centre.
    return tangent > 1e-12 ? Eigen::Vector2d(ideal * (Profile(r).value / tangent)) : Eigen::Vector2d(ideal * RadialFactor(0.0).value);
  }
  if (kind_ == Kind::kFisheye && tangent > 1e-12) ideal *= r / tangent;
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
  if (shift_.IsZero()) return ideal;

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
      // An angle of more than half a turn is another direction.
      if (kind_ == Kind::kFisheye && !(candidate.norm() <= Limit())) continue;
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
  if (kind_ == Kind::kFisheye) {
    const double distorted_radius = distorted.stableNorm();
    if (distorted_radius < 1e-300) return Eigen::Vector3d::UnitZ();
    if (shift_.IsZero()) {
      const double theta = InvertProfile(distorted_radius);
      const Eigen::Vector2d across = distorted * (std::sin(theta) / distorted_radius);
      return {across.x(), across.y(), std::cos(theta)};
    }
    const Eigen::Vector2d plane = UndistortPlane(distorted);
    const double theta = plane.norm();
    if (theta < 1e-150) return Eigen::Vector3d::UnitZ();
    const Eigen::Vector2d across = plane * (std::sin(theta) / theta);
    return {across.x(), across.y(), std::cos(theta)};
  }
  // stableNormalized: for far-off pixels the squared coordinates may overflow.
  return (is_ideal_ ? distorted : UndistortPlane(distorted)).homogeneous().stableNormalized();
}

}  // namespace skyquilt::camera
