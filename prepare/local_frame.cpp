#include <Eigen/Dense>
#include <cmath>

#include "core/base/order_statistics.h"
#include "prepare/georeference.h"

namespace skyquilt::prepare {
namespace {

// Norm of the mean viewing direction. Above this, cameras look the same way within about 37 degrees on average: a nadir flight.
constexpr double kConsistentView = 0.8;

Eigen::Vector3d MedianPoint(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Eigen::Vector3d& x : points) values.push_back(x[axis]);
    median[axis] = base::Median(values);
  }
  return median;
}

Eigen::Vector3d UpDirection(const std::vector<Station>& stations) {
  Eigen::Vector3d view = Eigen::Vector3d::Zero();
  Eigen::Vector3d camera_up = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_centre = Eigen::Vector3d::Zero();
  const auto n = static_cast<double>(stations.size());
  for (const Station& station : stations) {
    const Eigen::Quaterniond model_from_cam = station.cam_from_model.rotation.conjugate();
    view += model_from_cam * Eigen::Vector3d::UnitZ() / n;
    camera_up -= model_from_cam * Eigen::Vector3d::UnitY() / n;
    mean_centre += station.cam_from_model.OriginInSource() / n;
  }
  if (view.norm() > kConsistentView) return -view.normalized();

  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Station& station : stations) {
    const Eigen::Vector3d offset = station.cam_from_model.OriginInSource() - mean_centre;
    covariance += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d spread = solver.eigenvalues();  // ascending
  // Centres on one line define no plane: use the mean up direction of the cameras instead.
  Eigen::Vector3d up = spread[1] > 1e-6 * spread[2] ? Eigen::Vector3d(solver.eigenvectors().col(0)) : camera_up;
  if (!(up.norm() > 1e-9)) up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d hint = view.norm() > 0.1 ? Eigen::Vector3d(-view) : camera_up;
  return (up.dot(hint) < 0.0 ? -up : up).normalized();
}

}  // namespace

geo::Similarity3d LocalFrame(const std::vector<Station>& stations, const std::vector<Eigen::Vector3d>& points) {
  geo::Similarity3d local_from_model;
  if (stations.empty()) return local_from_model;
  std::vector<Eigen::Vector3d> centres;
  for (const Station& station : stations) centres.push_back(station.cam_from_model.OriginInSource());
  const Eigen::Vector3d origin = MedianPoint(points.empty() ? centres : points);
  std::vector<double> depths;
  for (const Station& station : stations) {
    std::vector<double> own;
    for (const Eigen::Vector3d& x : points) {
      const double depth = (station.cam_from_model * x).z();
      if (depth > 0.0) own.push_back(depth);
    }
    if (!own.empty()) depths.push_back(base::Median(own));
  }
  const double depth = base::Median(depths);
  local_from_model.rotation = Eigen::Quaterniond::FromTwoVectors(UpDirection(stations), Eigen::Vector3d::UnitZ()).normalized();
  local_from_model.scale = std::isfinite(depth) && depth > 0.0 ? kLocalDepth / depth : 1.0;
  local_from_model.translation = -(local_from_model.scale * (local_from_model.rotation * origin));
  return local_from_model;
}

}  // namespace skyquilt::prepare
