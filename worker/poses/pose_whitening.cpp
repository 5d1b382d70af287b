#include "worker/poses/pose_whitening.h"

#include <array>
#include <optional>

#include "core/geo/pose_gauge.h"
#include "core/linear/linear.h"

namespace skyquilt::worker {
namespace {

// Damping of CamP: relative to the diagonal, and absolute.
constexpr double kLambda = 0.1, kMu = 1e-8;
constexpr std::array<double, 3> kDistances = {0.7, 1.0, 1.4};
constexpr int kAcross = 5;      // places across the picture, and down
constexpr double kStep = 1e-5;  // of central differences: radians, and shares of the distance

Eigen::MatrixXd InverseRoot(const Eigen::MatrixXd& s) {
  Eigen::MatrixXd damped = s;
  damped.diagonal() += kLambda * s.diagonal() + Eigen::VectorXd::Constant(s.rows(), kMu);
  const linear::EigenPairs<Eigen::Dynamic> pairs = linear::SymmetricEigen<Eigen::Dynamic>(damped);
  const Eigen::VectorXd roots = pairs.values.cwiseMax(kMu).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = pairs.vectors * roots.asDiagonal();
  return scaled.lazyProduct(pairs.vectors.transpose());
}

}  // namespace

PoseWhitening WhitenPose(const camera::Camera& camera, double distance_m) {
  PoseMatrix sum = PoseMatrix::Zero();
  int places = 0;
  PoseVector steps;
  steps << Eigen::Vector3d::Constant(kStep), Eigen::Vector3d::Constant(kStep * distance_m);
  // Sums J^T J of one place; nothing for one that a changed pose does not show.
  const auto add = [&](const Eigen::Vector3d& place) {
    const auto project = [&](const PoseVector& x) { return camera.ImgFromCam(geo::RotationOfVector(-x.head<3>()) * (place - x.tail<3>())); };
    Eigen::Matrix<double, 2, 6> jacobian;
    for (int i = 0; i < 6; ++i) {
      const PoseVector step = steps[i] * PoseVector::Unit(i);
      const auto after = project(step), before = project(-step);
      if (!after || !before) return;
      jacobian.col(i) = (*after - *before) / (2.0 * steps[i]);
    }
    sum += jacobian.transpose().lazyProduct(jacobian);
    ++places;
  };
  for (int row = 0; row < kAcross; ++row) {
    for (int column = 0; column < kAcross; ++column) {
      const Eigen::Vector3d ray = camera.RayFromImg({(column + 0.5) * camera.width / kAcross, (row + 0.5) * camera.height / kAcross});
      for (const double share : kDistances) add(share * distance_m / std::max(0.1, ray.z()) * ray);
    }
  }
  const PoseMatrix mean = sum / std::max(1, places);
  return {InverseRoot(mean), mean};
}

}  // namespace skyquilt::worker
