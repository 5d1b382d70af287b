// Terms of the bundle adjustment with their derivatives. A pose is seven numbers: the quaternion x y z w of cam_from_enu and the camera's centre. Its
// changes are six: a rotation vector in the camera's frame (applied after cam_from_enu) and the centre's displacement. The costs write derivatives by
// these six in place of derivatives by the seven, with a zero in the seventh column, and PoseManifold passes them on; this saves a product of
// matrices and the derivatives of a quaternion. Such costs work with PoseManifold only.
#pragma once

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "core/geo/transform.h"
#include "prepare/bundle/adjusted_lens.h"

namespace skyquilt::prepare::bundle {

using PoseNumbers = std::array<double, 7>;

class PoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

// (projection - pixel) / unit: parameter blocks pose, lens, point.
class ReprojectionCost : public ceres::SizedCostFunction<2, 7, 8, 3> {
 public:
  ReprojectionCost(const Eigen::Vector2d& pixel, double unit_px) : pixel_(pixel), unit_px_(unit_px) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector2d pixel_;
  double unit_px_;
};

// The same for a camera of a rig: parameter blocks pose of the rig, lens, point.
class RigReprojectionCost : public ceres::SizedCostFunction<2, 7, 8, 3> {
 public:
  RigReprojectionCost(const geo::Rigid3d& cam_from_rig, const Eigen::Vector2d& pixel, double unit_px)
      : cam_from_rig_(cam_from_rig), pixel_(pixel), unit_px_(unit_px) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  geo::Rigid3d cam_from_rig_;
  Eigen::Vector2d pixel_;
  double unit_px_;
};

// (centre - gps) / sigma per axis: parameter block pose.
class PlaceCost : public ceres::SizedCostFunction<3, 7> {
 public:
  PlaceCost(const Eigen::Vector3d& gps, const Eigen::Vector3d& sigma) : gps_(gps), sigma_(sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d gps_, sigma_;
};

// (centre - gps - shift) / sigma per axis, for positions that are all off by the same: parameter blocks pose, shift.
class ShiftedPlaceCost : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  ShiftedPlaceCost(const Eigen::Vector3d& gps, const Eigen::Vector3d& sigma) : gps_(gps), sigma_(sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d gps_, sigma_;
};

// (point - place) / sigma per axis: parameter block point. An infinite sigma leaves its axis free.
class KnownPointCost : public ceres::SizedCostFunction<3, 3> {
 public:
  KnownPointCost(const Eigen::Vector3d& place, const Eigen::Vector3d& sigma) : place_(place), sigma_(sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d place_, sigma_;
};

// Rotation vector from the tagged rotation to the pose's, in the camera's frame, over sigma: parameter block pose.
class TurnCost : public ceres::SizedCostFunction<3, 7> {
 public:
  TurnCost(const Eigen::Quaterniond& cam_from_enu, double sigma_rad) : tagged_(cam_from_enu), sigma_rad_(sigma_rad) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Quaterniond tagged_;
  double sigma_rad_;
};

// (number - expected) / sigma of each number of the lens.
class LensCost : public ceres::SizedCostFunction<8, 8> {
 public:
  LensCost(const Lens& expected, const Lens& sigma) : expected_(expected), sigma_(sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Lens expected_, sigma_;
};

}  // namespace skyquilt::prepare::bundle
