#include <Eigen/Geometry>
#include <cmath>

#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "prepare/georeference/georeference.h"

namespace skyquilt::prepare::georeference {
namespace {

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

}  // namespace

geo::Similarity3d LocalFrame(const std::vector<input::PreparedPhoto>& photos, const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& up) {
  geo::Similarity3d local_from_model;
  if (photos.empty()) return local_from_model;
  std::vector<Eigen::Vector3d> centres;
  centres.reserve(photos.size());
  for (const input::PreparedPhoto& photo : photos) centres.push_back(photo.cam_from_model.OriginInSource());
  const Eigen::Vector3d origin = MedianPoint(points.empty() ? centres : points);
  std::vector<double> depths;
  for (const input::PreparedPhoto& photo : photos) {
    std::vector<double> own;
    for (const Eigen::Vector3d& x : points) {
      const double depth = (photo.cam_from_model * x).z();
      if (depth > 0.0) own.push_back(depth);
    }
    if (!own.empty()) depths.push_back(base::Median(own));
  }
  const double depth = base::Median(depths);
  local_from_model.rotation = linear::RotationBetween(up, Eigen::Vector3d::UnitZ()).normalized();
  local_from_model.scale = std::isfinite(depth) && depth > 0.0 ? kLocalDepth / depth : 1.0;
  local_from_model.translation = -(local_from_model.scale * (local_from_model.rotation * origin));
  return local_from_model;
}

}  // namespace skyquilt::prepare::georeference
