#include "prepare/georeference/filter_sparse_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "prepare/georeference/points_below.h"

namespace skyquilt::prepare::georeference {
namespace {

// With fewer good points than this number and this share of all, worse ones are kept too.
constexpr size_t kFewPoints = 1000;
constexpr double kFewShare = 0.2;
constexpr size_t kMinAglPoints = 3;

size_t CountGood(const std::vector<survey::SparsePoint>& points, double max_error_px, int min_track) {
  return static_cast<size_t>(std::count_if(points.begin(), points.end(), [&](const survey::SparsePoint& point) {
    return static_cast<double>(point.error_px) <= max_error_px && point.track_length >= min_track;
  }));
}

// Removes points outside the bounds of 99 % of the points, widened by their own extent: wrongly triangulated points, but not towers or distant hills.
// order: indices into points, from which those of outliers are removed.
void RemoveOutliers(const std::vector<survey::SparsePoint>& points, std::vector<size_t>& order) {
  if (order.size() < 20) return;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(order.size());
    for (const size_t i : order) values.push_back(points[i].x_in_enu[axis]);
    low[axis] = base::Quantile(values, 0.005);
    high[axis] = base::Quantile(std::move(values), 0.995);
  }
  // Perfectly flat ground must not make the margin zero.
  const double smallest = 1e-3 * (high - low).maxCoeff();
  const Eigen::Vector3d margin = (high - low).cwiseMax(smallest);
  std::erase_if(order, [&](size_t i) {
    const Eigen::Vector3d& x = points[i].x_in_enu;
    return (x.array() < (low - margin).array()).any() || (x.array() > (high + margin).array()).any();
  });
}

}  // namespace

std::vector<size_t> FilterSparsePoints(std::vector<survey::SparsePoint>& points) {
  const size_t n_all = points.size();
  std::vector<size_t> order(n_all);
  std::iota(order.begin(), order.end(), size_t{0});
  const size_t enough = std::min(kFewPoints, static_cast<size_t>(kFewShare * static_cast<double>(n_all)));
  const std::pair<double, int> conditions[] = {{kMaxPointErrorPx, kMinTrack}, {kMaxPointErrorPx, 2}, {std::numeric_limits<double>::infinity(), 0}};
  for (const auto& [max_error_px, min_track] : conditions) {
    if (CountGood(points, max_error_px, min_track) < enough) continue;
    std::erase_if(order, [&points, max = max_error_px, min = min_track](size_t i) {
      return !(static_cast<double>(points[i].error_px) <= max && points[i].track_length >= min);
    });
    break;
  }
  const size_t n_good = order.size();
  RemoveOutliers(points, order);
  for (size_t i = 0; i < order.size(); ++i) points[i] = points[order[i]];
  points.resize(order.size());
  base::LogInfo("sparse points: {} of {} kept ({} with a large error or short track and {} far outliers removed)", points.size(), n_all,
                n_all - n_good, n_good - points.size());
  return order;
}

void MeasureAgl(survey::Survey& survey, base::ThreadPool& threads) {
  const PointsBelow points(survey.points);
  threads.ParallelFor(static_cast<int64_t>(survey.photos.size()), [&](int64_t task, int /*thread*/) {
    survey::Photo& photo = survey.photos[static_cast<size_t>(task)];
    photo.agl_m = std::numeric_limits<double>::quiet_NaN();
    const Eigen::Vector3d centre = photo.cam_from_enu.OriginInSource();
    std::vector<std::pair<double, double>> below;  // horizontal distance squared, height
    points.Nearest(centre, kAglPoints, &below);
    if (below.size() < kMinAglPoints) return;
    std::vector<double> heights;
    for (const auto& [distance_squared, z] : below) heights.push_back(z);
    const double height = centre.z() - base::Median(heights);
    const double radius = 0.5 * height;
    std::vector<double> within;
    for (const auto& [distance_squared, z] : below) {
      if (distance_squared <= radius * radius) within.push_back(z);
    }
    if (within.size() >= kMinAglPoints) photo.agl_m = centre.z() - base::Median(within);
  });
}

}  // namespace skyquilt::prepare::georeference
