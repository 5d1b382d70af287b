#include "prepare/georeference/levelled_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "prepare/bundle/robust.h"
#include "prepare/georeference/georeference.h"

namespace skyquilt::prepare::georeference {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kFirstLag_s = -1.5, kLastLag_s = 5.0, kLagStep_s = 0.25;
constexpr double kLeastThreshold_m = 1.0;
constexpr double kThresholdSigmas = 2.0;
constexpr double kLineRatio = 0.05;

// Standard deviation per axis of the tags by the differences of neighbours, which a jump or a wrong fit hardly changes.
double LocalNoise(const std::vector<Vector2d>& residuals) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (size_t k = 1; k < residuals.size(); ++k) sizes.push_back((residuals[k] - residuals[k - 1]).norm());
  return sizes.empty() ? 0.0 : base::Median(sizes) / (bundle::kRayleighMedian * std::numbers::sqrt2);
}

}  // namespace

std::vector<double> LagsToTry(const TaggedFlight& flight) {
  std::vector<double> lags = {0.0};
  if (flight.options.tag_lag == "off" || !flight.track.timed()) return lags;
  for (double lag = kFirstLag_s; lag <= kLastLag_s; lag += kLagStep_s) lags.push_back(lag);
  return lags;
}

HorizontalFit FitLevelled(const TaggedFlight& flight, const std::vector<Tag>& tags, const Matrix3d& level_from_model) {
  std::vector<Vector2d> targets;
  targets.reserve(tags.size());
  for (const Tag& tag : tags) targets.push_back(tag.x_in_enu.head<2>());
  const auto level = [&](size_t k, double lag_s) {
    return Vector2d((level_from_model * flight.track.Before(tags[k].photo, lag_s).position).head<2>());
  };
  HorizontalFitOptions options{
      .threshold_m = flight.options.ransac_threshold_m, .lags_s = LagsToTry(flight), .seed = static_cast<uint64_t>(flight.options.seed)};
  HorizontalFit fit = FitHorizontally(targets, level, options);
  if (!fit.ok) return fit;
  // With a threshold that suits the noise, a fit that compromises between two groups of tags loses against one that follows the larger group.
  std::vector<Vector2d> residuals(tags.size());
  for (size_t k = 0; k < tags.size(); ++k) residuals[k] = fit.enu_from_level * level(k, fit.lag_s) - targets[k];
  options.threshold_m = std::min(options.threshold_m, std::max(kLeastThreshold_m, kThresholdSigmas * LocalNoise(residuals)));
  HorizontalFit narrow = FitHorizontally(targets, level, options);
  return narrow.n_inliers >= kMinAgreeing ? narrow : fit;
}

geo::Similarity3d SimilarityOfFit(const TaggedFlight& flight, const std::vector<Tag>& tags, const Eigen::Quaterniond& level_from_model,
                                  const HorizontalFit& fit) {
  const HorizontalSimilarity& flat = fit.enu_from_level;
  geo::Similarity3d result;
  result.scale = flat.scale;
  result.rotation = (Eigen::Quaterniond(Eigen::AngleAxisd(flat.angle, Vector3d::UnitZ())) * level_from_model).normalized();
  std::vector<double> heights, cameras;
  for (size_t k = 0; k < tags.size(); ++k) {
    const double z = result.scale * (result.rotation * flight.track.Before(tags[k].photo, fit.lag_s).position).z();
    cameras.push_back(z);
    if (fit.inlier[k] != 0 && std::isfinite(tags[k].x_in_enu.z())) heights.push_back(tags[k].x_in_enu.z() - z);
  }
  // Without heights the cameras are at the origin's height, as their tags say.
  result.translation = {flat.translation.x(), flat.translation.y(), heights.empty() ? -base::Median(cameras) : base::Median(heights)};
  return result;
}

HeightObservations ObserveHeights(const TaggedFlight& flight, const std::vector<Tag>& tags, const geo::Similarity3d& start, const HorizontalFit& fit,
                                  const Gravity& gravity, const Vector3d& middle) {
  const auto n = static_cast<Eigen::Index>(tags.size());
  HeightObservations heights;
  heights.height_m = Eigen::VectorXd::Zero(n);
  heights.sigma = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  heights.tilt = Eigen::MatrixX2d::Zero(n, 2);
  const Vector3d middle_in_enu = start * middle;
  for (size_t k = 0; k < tags.size(); ++k) {
    const Vector3d x = start * flight.track.Before(tags[k].photo, fit.lag_s).position;
    const auto row = static_cast<Eigen::Index>(k);
    // A rotation w about the middle raises a point at r by w x r.
    const Vector3d arm = x - middle_in_enu;
    heights.tilt.row(row) = Eigen::RowVector2d(arm.y(), -arm.x());
    if (fit.inlier[k] == 0 || !std::isfinite(tags[k].x_in_enu.z())) continue;
    heights.height_m[row] = tags[k].x_in_enu.z() - x.z();
    heights.sigma[row] = tags[k].vertical_sigma_m;
  }
  const Matrix3d rotation = start.rotation.toRotationMatrix();
  const Matrix3d information = rotation * gravity.information * rotation.transpose();
  // A rotation (wx, wy) moves up by (wy, -wx).
  Eigen::Matrix2d turn;
  turn << 0.0, 1.0, -1.0, 0.0;
  heights.tilt_information = turn.transpose() * information.topLeftCorner<2, 2>() * turn;
  return heights;
}

geo::Similarity3d Turned(const geo::Similarity3d& start, const Vector3d& point, const Eigen::VectorXd& solution) {
  const Vector3d turn(solution[1], solution[2], 0.0);
  const double angle = turn.norm();
  const Eigen::Quaterniond rotation(angle > 0.0 ? Eigen::AngleAxisd(angle, turn / angle) : Eigen::AngleAxisd::Identity());
  geo::Similarity3d turned = start;
  turned.rotation = (rotation * start.rotation).normalized();
  turned.translation = point + Vector3d(0.0, 0.0, solution[0]) + rotation * (start.translation - point);
  return turned;
}

bool OnOneLine(const std::vector<input::PreparedPhoto>& photos, const Matrix3d& level_from_model) {
  Eigen::Matrix2Xd x(2, static_cast<Eigen::Index>(photos.size()));
  for (size_t i = 0; i < photos.size(); ++i) {
    x.col(static_cast<Eigen::Index>(i)) = (level_from_model * photos[i].cam_from_model.OriginInSource()).head<2>();
  }
  const Eigen::Matrix2Xd centred = x.colwise() - x.rowwise().mean();
  const Eigen::Matrix2d spread = centred.lazyProduct(centred.transpose());
  const Eigen::Vector2d value = linear::SymmetricEigen(spread).values.cwiseMax(0.0).cwiseSqrt();
  return value[0] <= kLineRatio * value[1];
}

}  // namespace skyquilt::prepare::georeference
