#include "core/geo/pose_gauge.h"

#include <cmath>

#include "core/base/errors.h"
#include "core/linear/linear.h"

namespace skyquilt::geo {
namespace {

Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

}  // namespace

Eigen::Quaterniond RotationOfVector(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  // sin(angle / 2) / angle
  const double share = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), share * vector.x(), share * vector.y(), share * vector.z()};
}

Eigen::Vector3d VectorOfRotation(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * rotation.vec();
  const double sine = v.norm();
  if (sine < 1e-9) return 2.0 * v;
  return 2.0 * std::atan2(sine, sign * rotation.w()) / sine * v;
}

Eigen::Matrix3d RightJacobianOfRotation(const Eigen::Vector3d& vector) {
  const double angle2 = vector.squaredNorm(), angle = std::sqrt(angle2);
  const Eigen::Matrix3d cross = Cross(vector);
  const bool tiny = angle < 1e-4;
  const double first = tiny ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
  const double second = tiny ? 1.0 / 6.0 - angle2 / 120.0 : (angle - std::sin(angle)) / (angle2 * angle);
  return Eigen::Matrix3d::Identity() - first * cross + second * (cross * cross);
}

Similarity3d SmallSimilarity(std::span<const Rigid3d> given, std::span<const Rigid3d> changed, std::span<const double> weights, double arm_m) {
  SKYQUILT_CHECK(given.size() == changed.size() && given.size() == weights.size(), "one changed pose and one weight per pose");
  SKYQUILT_CHECK(arm_m > 0.0, "the arm must be positive");
  double total = 0.0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < given.size(); ++i) {
    total += weights[i];
    middle += weights[i] * given[i].translation;
  }
  if (!(total > 0.0)) return {};
  middle /= total;
  // Unknowns: shift, rotation vector, and growth of the scale, about the middle.
  linear::Square<7> normal = linear::Square<7>::Zero();
  linear::Vector<7> right = linear::Vector<7>::Zero();
  for (size_t i = 0; i < given.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    const Eigen::Vector3d from = given[i].translation - middle, moved = changed[i].translation - given[i].translation;
    const Eigen::Vector3d turned = VectorOfRotation(changed[i].rotation * given[i].rotation.conjugate());
    Eigen::Matrix<double, 6, 7> a = Eigen::Matrix<double, 6, 7>::Zero();
    a.block<3, 3>(0, 0).setIdentity();
    a.block<3, 3>(0, 3) = -Cross(from);
    a.col(6).head<3>() = from;
    a.block<3, 3>(3, 3) = arm_m * Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, 6, 1> b;
    b << moved, arm_m * turned;
    normal += weights[i] * a.transpose().lazyProduct(a);
    right += weights[i] * a.transpose().lazyProduct(b);
  }
  // The scale of cameras at one place is not known; it stays.
  normal(6, 6) += 1e-12 * total * arm_m * arm_m;
  const linear::Vector<7> x = linear::SolveSymmetric<7>(normal, right);
  Similarity3d b_from_a;
  b_from_a.scale = 1.0 + x[6];
  b_from_a.rotation = RotationOfVector(x.segment<3>(3));
  b_from_a.translation = middle + x.head<3>() - b_from_a.scale * (b_from_a.rotation * middle);
  return b_from_a;
}

void RemoveSimilarity(std::span<const Rigid3d> given, std::span<const double> weights, double arm_m, std::span<Rigid3d> changed) {
  constexpr int kRounds = 3;  // each leaves the products of what is left
  for (int round = 0; round < kRounds; ++round) {
    const Similarity3d s = SmallSimilarity(given, changed, weights, arm_m);
    const Eigen::Quaterniond back = s.rotation.conjugate();
    for (Rigid3d& pose : changed) {
      pose.rotation = (back * pose.rotation).normalized();
      pose.translation = back * (pose.translation - s.translation) / s.scale;
    }
  }
}

}  // namespace skyquilt::geo
