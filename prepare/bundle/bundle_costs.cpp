#include "prepare/bundle/bundle_costs.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::prepare::bundle {
namespace {

template <int rows, int cols>
using RowMajor = Eigen::Matrix<double, rows, cols, Eigen::RowMajor>;

template <int rows, int cols>
Eigen::Map<RowMajor<rows, cols>> MatrixAt(double* numbers) {
  return Eigen::Map<RowMajor<rows, cols>>(numbers);
}
template <int size>
Eigen::Map<Eigen::Vector<double, size>> VectorAt(double* numbers) {
  return Eigen::Map<Eigen::Vector<double, size>>(numbers);
}
template <int size>
Eigen::Vector<double, size> CopyOf(const double* numbers) {
  return Eigen::Map<const Eigen::Vector<double, size>>(numbers);
}

Eigen::Quaterniond RotationOf(const double* pose) {
  return Eigen::Quaterniond(CopyOf<4>(pose));
}
Eigen::Vector3d CentreOf(const double* pose) {
  return CopyOf<3>(pose + 4);
}

Eigen::Matrix3d CrossOf(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return cross;
}

Eigen::Quaterniond Exp(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (angle < 1e-12) return Eigen::Quaterniond(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z()).normalized();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

Eigen::Vector3d Log(Eigen::Quaterniond q) {
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

}  // namespace

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Quaterniond rotation = (Exp(CopyOf<3>(delta)) * RotationOf(x)).normalized();
  VectorAt<4>(x_plus_delta) = rotation.coeffs();
  VectorAt<3>(x_plus_delta + 4) = CentreOf(x) + CopyOf<3>(delta + 3);
  return true;
}

bool PoseManifold::PlusJacobian(const double* /*x*/, double* jacobian) const {
  auto map = MatrixAt<7, 6>(jacobian);
  map.setZero();
  map.topRows<6>().setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  VectorAt<3>(y_minus_x) = Log(RotationOf(y) * RotationOf(x).conjugate());
  VectorAt<3>(y_minus_x + 3) = CentreOf(y) - CentreOf(x);
  return true;
}

bool PoseManifold::MinusJacobian(const double* /*x*/, double* jacobian) const {
  auto map = MatrixAt<6, 7>(jacobian);
  map.setZero();
  map.leftCols<6>().setIdentity();
  return true;
}

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Quaterniond rotation = RotationOf(parameters[0]);
  Lens lens;
  std::copy_n(parameters[1], lens.size(), lens.begin());
  const Eigen::Vector3d x_in_cam = rotation * (CopyOf<3>(parameters[2]) - CentreOf(parameters[0]));
  LensJacobian jacobian;
  const Eigen::Vector2d pixel = Project(lens, x_in_cam, jacobians != nullptr ? &jacobian : nullptr);
  VectorAt<2>(residuals) = (pixel - pixel_) / unit_px_;
  if (jacobians == nullptr) return true;
  jacobian.by_point /= unit_px_;
  const Eigen::Matrix<double, 2, 3> by_x = jacobian.by_point * rotation.toRotationMatrix();
  if (jacobians[0] != nullptr) {
    auto by_pose = MatrixAt<2, 7>(jacobians[0]);
    by_pose.leftCols<3>() = -jacobian.by_point * CrossOf(x_in_cam);
    by_pose.middleCols<3>(3) = -by_x;
    by_pose.col(6).setZero();
  }
  if (jacobians[1] != nullptr) MatrixAt<2, 8>(jacobians[1]) = jacobian.by_lens / unit_px_;
  if (jacobians[2] != nullptr) MatrixAt<2, 3>(jacobians[2]) = by_x;
  return true;
}

bool RigReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Quaterniond rotation = RotationOf(parameters[0]);
  Lens lens;
  std::copy_n(parameters[1], lens.size(), lens.begin());
  const Eigen::Vector3d x_in_rig = rotation * (CopyOf<3>(parameters[2]) - CentreOf(parameters[0]));
  LensJacobian jacobian;
  const Eigen::Vector2d pixel = Project(lens, cam_from_rig_ * x_in_rig, jacobians != nullptr ? &jacobian : nullptr);
  VectorAt<2>(residuals) = (pixel - pixel_) / unit_px_;
  if (jacobians == nullptr) return true;
  const Eigen::Matrix<double, 2, 3> by_x_in_rig = jacobian.by_point * cam_from_rig_.rotation.toRotationMatrix() / unit_px_;
  const Eigen::Matrix<double, 2, 3> by_x = by_x_in_rig * rotation.toRotationMatrix();
  if (jacobians[0] != nullptr) {
    auto by_pose = MatrixAt<2, 7>(jacobians[0]);
    by_pose.leftCols<3>() = -by_x_in_rig * CrossOf(x_in_rig);
    by_pose.middleCols<3>(3) = -by_x;
    by_pose.col(6).setZero();
  }
  if (jacobians[1] != nullptr) MatrixAt<2, 8>(jacobians[1]) = jacobian.by_lens / unit_px_;
  if (jacobians[2] != nullptr) MatrixAt<2, 3>(jacobians[2]) = by_x;
  return true;
}

bool PlaceCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  VectorAt<3>(residuals) = (CentreOf(parameters[0]) - gps_).cwiseQuotient(sigma_);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    auto by_pose = MatrixAt<3, 7>(jacobians[0]);
    by_pose.setZero();
    for (int axis = 0; axis < 3; ++axis) by_pose(axis, 3 + axis) = 1.0 / sigma_[axis];
  }
  return true;
}

bool ShiftedPlaceCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  VectorAt<3>(residuals) = (CentreOf(parameters[0]) - gps_ - CopyOf<3>(parameters[1])).cwiseQuotient(sigma_);
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    auto by_pose = MatrixAt<3, 7>(jacobians[0]);
    by_pose.setZero();
    for (int axis = 0; axis < 3; ++axis) by_pose(axis, 3 + axis) = 1.0 / sigma_[axis];
  }
  if (jacobians[1] != nullptr) MatrixAt<3, 3>(jacobians[1]) = -sigma_.cwiseInverse().asDiagonal().toDenseMatrix();
  return true;
}

bool KnownPointCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  VectorAt<3>(residuals) = (CopyOf<3>(parameters[0]) - place_).cwiseQuotient(sigma_);
  if (jacobians != nullptr && jacobians[0] != nullptr) MatrixAt<3, 3>(jacobians[0]) = sigma_.cwiseInverse().asDiagonal().toDenseMatrix();
  return true;
}

bool TurnCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Eigen::Vector3d turn = Log(RotationOf(parameters[0]) * tagged_.conjugate());
  VectorAt<3>(residuals) = turn / sigma_rad_;
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    // Inverse of the left Jacobian of SO(3) (Barfoot, State Estimation for Robotics, 2017, equation 7.77).
    const double angle = turn.norm();
    const Eigen::Matrix3d cross = CrossOf(turn);
    const double square =
        angle < 1e-4 ? 1.0 / 12.0 : 1.0 / (angle * angle) - (1.0 + std::cos(angle)) / (2.0 * angle * std::max(std::sin(angle), 1e-12));
    auto by_pose = MatrixAt<3, 7>(jacobians[0]);
    by_pose.setZero();
    by_pose.leftCols<3>() = (Eigen::Matrix3d::Identity() - 0.5 * cross + square * cross * cross) / sigma_rad_;
  }
  return true;
}

bool LensCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  for (size_t i = 0; i < expected_.size(); ++i) residuals[i] = (parameters[0][i] - expected_[i]) / sigma_[i];
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    auto by_lens = MatrixAt<8, 8>(jacobians[0]);
    by_lens.setZero();
    for (int i = 0; i < 8; ++i) by_lens(i, i) = 1.0 / sigma_[static_cast<size_t>(i)];
  }
  return true;
}

}  // namespace skyquilt::prepare::bundle
