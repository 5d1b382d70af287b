#include "buildings/fit/ground_level.h"

#include <algorithm>
#include <cmath>

#include "buildings/fit/correlation.h"
#include "core/base/order_statistics.h"
#include "core/linear/linear.h"

namespace skyquilt::buildings {
namespace {

constexpr size_t kLeastGroundPoints = 10;
constexpr double kSteepest = 0.3;           // of the ground; with fewer points than on all sides a plane is not believed beyond
constexpr double kSlopeSigma = 0.1;         // of slopes before points are seen
constexpr double kGroundCommon_gsd = 0.35;  // error that all points have in common
constexpr int kSteps = 15;

}  // namespace

Measure GroundLevel(const std::vector<FitPoint>& points, const Eigen::Vector2d& middle, double gsd_m, double spacing_m) {
  if (points.size() < kLeastGroundPoints) return {};
  std::vector<double> heights;
  heights.reserve(points.size());
  for (const FitPoint& point : points) heights.push_back(point.z);
  const double scale = std::max(gsd_m, base::Nmad(heights));
  // z = level + slope . (place - middle), Cauchy loss, slopes held towards 0 where points lie on one side only.
  Eigen::Vector3d plane(base::Median(std::move(heights)), 0.0, 0.0);
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  for (int step = 0; step < kSteps; ++step) {
    const double now = std::max(0.5 * gsd_m, scale * std::pow(0.7, step));
    information = Eigen::Vector3d(0.0, 1.0, 1.0).asDiagonal();
    information *= now * now / (kSlopeSigma * kSlopeSigma);
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const FitPoint& point : points) {
      const Eigen::Vector3d row(1.0, point.place.x() - middle.x(), point.place.y() - middle.y());
      const double r = (point.z - row.dot(plane)) / now;
      const double weight = 1.0 / (1.0 + r * r);
      information += weight * row * row.transpose();
      right += weight * point.z * row;
    }
    const Eigen::Vector3d better = linear::SolveSymmetric(information, right);
    if (!better.allFinite()) break;
    plane = better;
    plane.tail<2>() = plane.tail<2>().cwiseMax(-kSteepest).cwiseMin(kSteepest);
  }
  std::vector<Eigen::Vector2d> at;
  std::vector<double> residuals;
  for (const FitPoint& point : points) {
    at.push_back(point.place);
    residuals.push_back(point.z - plane.dot(Eigen::Vector3d(1.0, point.place.x() - middle.x(), point.place.y() - middle.y())));
  }
  const double sigma = std::max(base::Nmad(residuals), 0.1 * gsd_m);
  for (double& r : residuals) r = std::clamp(r, -3.0 * sigma, 3.0 * sigma);
  const auto n = static_cast<double>(points.size());
  const double area = n * spacing_m * spacing_m;
  const double n_eff = std::clamp(area / std::max(CorrelationArea(at, residuals, area), 1e-9), 1.0, n);
  const double random = sigma * sigma * n / n_eff * linear::Inverse(information)(0, 0);
  return {plane[0], std::sqrt(random + kGroundCommon_gsd * kGroundCommon_gsd * gsd_m * gsd_m)};
}

}  // namespace skyquilt::buildings
