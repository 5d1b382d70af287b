// Least-squares planes from sums over points, which can be added.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/linear/linear.h"

namespace skyquilt::buildings {

// normal . (x - middle) = 0; positions relative to PointCloud::middle.
struct FittedPlane {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double rms_m = 0.0;      // distance of the points
  double roughness = 0.0;  // smallest eigenvalue of their covariance over the sum: 0 planar, 1/3 scattered in all directions

  double Distance(const Eigen::Vector3f& position) const { return normal.dot(position.cast<double>() - middle); }
};

class PlaneSums {
 public:
  void Add(const Eigen::Vector3f& position) {
    const Eigen::Vector3d x = position.cast<double>();
    n_ += 1.0;
    sum_ += x;
    squares_ += x * x.transpose();
  }
  void Add(const PlaneSums& other) {
    n_ += other.n_;
    sum_ += other.sum_;
    squares_ += other.squares_;
  }
  double n() const { return n_; }
  // Its normal on the side of `out`. Needs a point; fewer than three give a plane of any direction.
  FittedPlane Fit(const Eigen::Vector3d& out) const {
    FittedPlane plane;
    plane.middle = sum_ / n_;
    const Eigen::Matrix3d covariance = squares_ / n_ - plane.middle * plane.middle.transpose();
    const linear::EigenPairs<3> eigen = linear::SymmetricEigen(covariance);
    plane.normal = eigen.vectors.col(0);
    if (plane.normal.dot(out) < 0.0) plane.normal = -plane.normal;
    const double smallest = std::max(eigen.values[0], 0.0), sum = eigen.values.cwiseMax(0.0).sum();
    plane.rms_m = std::sqrt(smallest);
    plane.roughness = sum > 0.0 ? smallest / sum : 0.0;
    return plane;
  }

 private:
  double n_ = 0.0;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares_ = Eigen::Matrix3d::Zero();
};

}  // namespace skyquilt::buildings
