#include "prepare/georeference.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/geo/robust_similarity.h"
#include "prepare/height_bias.h"
#include "prepare/horizontal_fit.h"
#include "prepare/place_adjustment.h"
#include "prepare/place_problems.h"
#include "prepare/robust.h"
#include "prepare/tag_checks.h"
#include "prepare/track.h"

namespace skyquilt::prepare {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180.0 / std::numbers::pi;
// A receiver's error that all its tags share is invisible in residuals. Shares of the stated or typical accuracy: 1.5 m and 3 m without RTK.
constexpr double kCommonHorizontal = 0.5;
constexpr double kCommonVertical = 2.0 / 3.0;
// Receivers lag by up to a few seconds; RTK drones record the time of exposure.
constexpr double kLagSigma_s = 1.5;
constexpr double kRtkLagSigma_s = 0.05;
constexpr double kFirstLag_s = -1.5, kLastLag_s = 5.0, kLagStep_s = 0.25;
constexpr double kLineRatio = 0.05;
constexpr double kLeastThreshold_m = 1.0;
constexpr double kLeastGroupRadius_m = 2.0, kGroupSigmas = 3.0, kGroupShare = 0.2;
constexpr double kThresholdSigmas = 2.0;
constexpr double kMaxUsefulSigma_deg = 5.0;

double Pick(const Vector3d& x, int axis) {
  return x[axis];
}

// The tagged position with a height that can be computed with.
geo::Geodetic Place(const geo::Geodetic& gps) {
  return {gps.latitude_deg, gps.longitude_deg, std::isfinite(gps.height_m) ? gps.height_m : 0.0};
}

// Medians are taken in an ENU frame, which has no special case at the poles and the date line. The frame starts at one of the tags and is moved to
// the median, where it is level.
geo::Geodetic MedianPosition(const std::vector<Station>& stations) {
  std::vector<double> heights;
  std::optional<geo::Geodetic> centre;
  for (const Station& station : stations) {
    if (!station.gps) continue;
    if (std::isfinite(station.gps->height_m)) heights.push_back(station.gps->height_m);
    if (!centre) centre = Place(*station.gps);
  }
  const double height_m = heights.empty() ? 0.0 : base::Median(heights);
  centre->height_m = height_m;
  for (int round = 0; round < 3; ++round) {
    const geo::EnuFrame frame(*centre);
    std::vector<double> axis[3];
    for (const Station& station : stations) {
      if (!station.gps) continue;
      const Vector3d x = frame.EnuFromGeodetic({station.gps->latitude_deg, station.gps->longitude_deg, height_m});
      for (int i = 0; i < 3; ++i) axis[i].push_back(Pick(x, i));
    }
    centre = frame.GeodeticFromEnu({base::Median(axis[0]), base::Median(axis[1]), base::Median(axis[2])});
  }
  return {centre->latitude_deg, centre->longitude_deg, height_m};
}

// Tags in ENU about `origin`, in the order of the track. Heights that say nothing are NaN.
std::vector<Tag> CollectTags(const std::vector<Station>& stations, const std::vector<size_t>& order, const geo::Geodetic& origin,
                             HeightTags heights) {
  const geo::EnuFrame frame(origin);
  std::vector<Tag> tags;
  for (const size_t i : order) {
    const Station& station = stations[i];
    if (!station.gps) continue;
    geo::Geodetic place = *station.gps;
    if (heights == HeightTags::kRelative) place.height_m = station.relative_altitude_m.value_or(kNan);
    const bool usable = heights != HeightTags::kUnknown && std::isfinite(place.height_m);
    if (!usable) place.height_m = origin.height_m;
    Tag tag{.station = i,
            .x_in_enu = frame.EnuFromGeodetic(place),
            .horizontal_sigma_m = station.horizontal_sigma_m,
            .vertical_sigma_m = station.vertical_sigma_m};
    if (!usable) tag.x_in_enu.z() = kNan;
    tags.push_back(tag);
  }
  return tags;
}

void Clear(size_t n, Georeference& result) {
  result.correction_m.assign(n, Vector3d::Zero());
  result.residual_m.assign(n, Vector3d::Constant(kNan));
  result.inlier.assign(n, 0);
}

// Residuals and the errors of the fit, from the transform and the corrections in `result`.
void Evaluate(const std::vector<Station>& stations, const std::vector<Tag>& tags, double threshold_m, Georeference& result) {
  survey::GeoFit& fit = result.fit;
  fit.n_matches = static_cast<int>(tags.size());
  fit.n_inliers = 0;
  fit.scale = result.enu_from_model.scale;
  double horizontal = 0.0, vertical = 0.0;
  int n_heights = 0;
  for (const Tag& tag : tags) {
    const size_t i = tag.station;
    const Vector3d centre = result.enu_from_model * stations[i].cam_from_model.OriginInSource();
    const Vector3d residual = centre - (tag.x_in_enu + result.correction_m[i]);
    result.residual_m[i] = residual;
    const bool has_height = std::isfinite(residual.z());
    const bool agrees = residual.head<2>().norm() <= threshold_m && (!has_height || std::abs(residual.z()) <= threshold_m);
    result.inlier[i] = agrees ? 1 : 0;
    if (!agrees) continue;
    ++fit.n_inliers;
    horizontal += residual.head<2>().squaredNorm();
    if (!has_height) continue;
    vertical += residual.z() * residual.z();
    ++n_heights;
  }
  fit.rmse_horizontal_m = fit.n_inliers > 0 ? std::sqrt(horizontal / fit.n_inliers) : kNan;
  fit.rmse_vertical_m = n_heights > 0 ? std::sqrt(vertical / n_heights) : kNan;
  fit.rmse_m = n_heights > 0 ? std::hypot(fit.rmse_horizontal_m, fit.rmse_vertical_m) : fit.rmse_horizontal_m;
}

// The flight with most RTK tags, else with most tags.
int ReferenceFlight(const std::vector<Station>& stations, const std::vector<Tag>& tags, const std::vector<int>& flight) {
  std::vector<int> n_tagged(static_cast<size_t>(CountFlights(flight)), 0), n_rtk = n_tagged;
  for (const Tag& tag : tags) {
    ++n_tagged[static_cast<size_t>(flight[tag.station])];
    n_rtk[static_cast<size_t>(flight[tag.station])] += stations[tag.station].rtk ? 1 : 0;
  }
  const std::vector<int>& votes = *std::max_element(n_rtk.begin(), n_rtk.end()) > 0 ? n_rtk : n_tagged;
  return static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

// Ratio of the second largest spread of the horizontal positions to the largest.
double LineRatio(const std::vector<Station>& stations, const Matrix3d& level_from_model) {
  Eigen::Matrix2Xd x(2, static_cast<Eigen::Index>(stations.size()));
  for (size_t i = 0; i < stations.size(); ++i) {
    x.col(static_cast<Eigen::Index>(i)) = (level_from_model * stations[i].cam_from_model.OriginInSource()).head<2>();
  }
  const Eigen::Matrix2Xd centred = x.colwise() - x.rowwise().mean();
  const Eigen::Matrix2d spread = centred * centred.transpose();
  const Eigen::Vector2d value = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return value[1] > 0.0 ? value[0] / value[1] : 0.0;
}

// The fit to positions alone, for comparison.
struct TagsAlone {
  bool ok = false;
  Vector3d up_in_model = Vector3d::UnitZ();
  double sigma_deg = kNan;
  geo::Similarity3d enu_from_model;
};

TagsAlone FitTagsAlone(const std::vector<Station>& stations, const std::vector<Tag>& tags, const PrepareOptions& options) {
  std::vector<Vector3d> in_model, in_enu;
  for (const Tag& tag : tags) {
    if (!tag.x_in_enu.allFinite()) continue;
    in_model.push_back(stations[tag.station].cam_from_model.OriginInSource());
    in_enu.push_back(tag.x_in_enu);
  }
  const geo::RobustSimilarityFit fit = geo::FitSimilarityRobustly(
      in_model, in_enu, {.inlier_threshold_m = options.ransac_threshold_m, .iterations = 2000, .seed = static_cast<uint64_t>(options.seed)});
  TagsAlone alone{.ok = fit.ok, .enu_from_model = fit.b_from_a};
  if (!fit.ok) return alone;
  alone.up_in_model = fit.b_from_a.rotation.conjugate() * Vector3d::UnitZ();
  Eigen::Matrix3Xd inliers(3, fit.n_inliers);
  Eigen::Index column = 0;
  for (size_t k = 0; k < in_enu.size(); ++k) {
    if (fit.inlier[k] != 0) inliers.col(column++) = in_enu[k];
  }
  const Eigen::Matrix3Xd centred = inliers.colwise() - inliers.rowwise().mean();
  const Eigen::Vector3d spread = Eigen::JacobiSVD<Eigen::Matrix3Xd>(centred).singularValues();
  alone.sigma_deg = kDegrees * fit.rmse_m / std::max(spread[1], 1e-9);
  return alone;
}

// Tags that disagree with the result by about the same horizontal shift, as after a jump of the receiver.
struct SecondGroup {
  int n = 0;
  double distance_m = 0.0;
};

SecondGroup FindSecondGroup(const std::vector<Tag>& tags, const Georeference& result, double noise_m) {
  std::vector<Vector2d> others;
  for (const Tag& tag : tags) {
    if (result.inlier[tag.station] == 0) others.emplace_back(result.residual_m[tag.station].head<2>());
  }
  const double radius_m = std::max(kLeastGroupRadius_m, kGroupSigmas * noise_m);
  SecondGroup best;
  for (const Vector2d& centre : others) {
    const auto n = static_cast<int>(std::count_if(others.begin(), others.end(), [&](const Vector2d& x) { return (x - centre).norm() <= radius_m; }));
    if (n > best.n && centre.norm() > radius_m) best = {n, centre.norm()};
  }
  const bool counts = best.n >= kMinAgreeing && static_cast<double>(best.n) >= kGroupShare * static_cast<double>(tags.size());
  return counts ? best : SecondGroup{};
}

// Everything that a fit of one set of tags needs.
struct Survey {
  const std::vector<Station>& stations;
  const Track& track;
  const std::vector<int>& flight;
  const PrepareOptions& options;
};

std::vector<double> LagsToTry(const Survey& survey) {
  std::vector<double> lags = {0.0};
  if (survey.options.tag_lag == "off" || !survey.track.timed()) return lags;
  for (double lag = kFirstLag_s; lag <= kLastLag_s; lag += kLagStep_s) lags.push_back(lag);
  return lags;
}

// Standard deviation per axis of the tags by the differences of neighbours, which a jump or a wrong fit hardly changes.
double LocalNoise(const std::vector<Vector2d>& residuals) {
  std::vector<double> sizes;
  sizes.reserve(residuals.size());
  for (size_t k = 1; k < residuals.size(); ++k) sizes.push_back((residuals[k] - residuals[k - 1]).norm());
  return sizes.empty() ? 0.0 : base::Median(sizes) / (kRayleighMedian * std::numbers::sqrt2);
}

HorizontalFit FitLevelled(const Survey& survey, const std::vector<Tag>& tags, const Matrix3d& level_from_model) {
  std::vector<Vector2d> targets;
  targets.reserve(tags.size());
  for (const Tag& tag : tags) targets.push_back(tag.x_in_enu.head<2>());
  const auto level = [&](size_t k, double lag_s) {
    return Vector2d((level_from_model * survey.track.Before(tags[k].station, lag_s).position).head<2>());
  };
  HorizontalFitOptions options{
      .threshold_m = survey.options.ransac_threshold_m, .lags_s = LagsToTry(survey), .seed = static_cast<uint64_t>(survey.options.seed)};
  HorizontalFit fit = FitHorizontally(targets, level, options);
  if (!fit.ok) return fit;
  // With a threshold that suits the noise, a fit that compromises between two groups of tags loses against one that follows the larger group.
  std::vector<Vector2d> residuals(tags.size());
  for (size_t k = 0; k < tags.size(); ++k) residuals[k] = fit.enu_from_level * level(k, fit.lag_s) - targets[k];
  options.threshold_m = std::min(options.threshold_m, std::max(kLeastThreshold_m, kThresholdSigmas * LocalNoise(residuals)));
  HorizontalFit narrow = FitHorizontally(targets, level, options);
  return narrow.n_inliers >= kMinAgreeing ? narrow : fit;
}

// The similarity of a horizontal fit; its height comes from the median of the tags.
geo::Similarity3d Raised(const Survey& survey, const std::vector<Tag>& tags, const Eigen::Quaterniond& level_from_model, const HorizontalFit& fit) {
  const HorizontalSimilarity& flat = fit.enu_from_level;
  geo::Similarity3d result;
  result.scale = flat.scale;
  result.rotation = (Eigen::Quaterniond(Eigen::AngleAxisd(flat.angle, Vector3d::UnitZ())) * level_from_model).normalized();
  std::vector<double> heights, cameras;
  for (size_t k = 0; k < tags.size(); ++k) {
    const double z = result.scale * (result.rotation * survey.track.Before(tags[k].station, fit.lag_s).position).z();
    cameras.push_back(z);
    if (fit.inlier[k] != 0 && std::isfinite(tags[k].x_in_enu.z())) heights.push_back(tags[k].x_in_enu.z() - z);
  }
  // Without heights the cameras are at the origin's height, as their tags say.
  result.translation = {flat.translation.x(), flat.translation.y(), heights.empty() ? -base::Median(cameras) : base::Median(heights)};
  return result;
}

HeightObservations Heights(const Survey& survey, const std::vector<Tag>& tags, const geo::Similarity3d& start, const HorizontalFit& fit,
                           const Gravity& gravity, const Vector3d& middle) {
  const auto n = static_cast<Eigen::Index>(tags.size());
  HeightObservations heights;
  heights.height_m = Eigen::VectorXd::Zero(n);
  heights.sigma = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  heights.tilt = Eigen::MatrixX2d::Zero(n, 2);
  const Vector3d middle_in_enu = start * middle;
  for (size_t k = 0; k < tags.size(); ++k) {
    const Vector3d x = start * survey.track.Before(tags[k].station, fit.lag_s).position;
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

// `start` rotated about a point and raised, by the first three numbers of a solution for the heights.
geo::Similarity3d Turned(const geo::Similarity3d& start, const Vector3d& point, const Eigen::VectorXd& solution) {
  const Vector3d turn(solution[1], solution[2], 0.0);
  const double angle = turn.norm();
  const Eigen::Quaterniond rotation(angle > 0.0 ? Eigen::AngleAxisd(angle, turn / angle) : Eigen::AngleAxisd::Identity());
  geo::Similarity3d turned = start;
  turned.rotation = (rotation * start.rotation).normalized();
  turned.translation = point + Vector3d(0.0, 0.0, solution[0]) + rotation * (start.translation - point);
  return turned;
}

double MedianSigma(const std::vector<Tag>& tags, double Tag::*sigma) {
  std::vector<double> values;
  values.reserve(tags.size());
  for (const Tag& tag : tags) values.push_back(tag.*sigma);
  return base::Median(values);
}

geo::PlaceAccuracy AccuracyOf(const Adjustment& adjustment, const std::vector<Tag>& tags, HeightTags heights, double vertical_span_m) {
  const auto& covariance = adjustment.covariance;
  const double common_h = kCommonHorizontal * MedianSigma(tags, &Tag::horizontal_sigma_m);
  const double common_v = kCommonVertical * MedianSigma(tags, &Tag::vertical_sigma_m);
  geo::PlaceAccuracy accuracy;
  accuracy.scale_percent = 100.0 * std::sqrt(covariance(3, 3));
  accuracy.tilt_deg = kDegrees * std::sqrt(covariance(0, 0) + covariance(1, 1));
  accuracy.yaw_deg = kDegrees * std::sqrt(covariance(2, 2));
  accuracy.horizontal_m = std::sqrt(covariance(4, 4) + covariance(5, 5) + 2.0 * common_h * common_h);
  // Which moment of a drift has the right height is unknown.
  if (heights == HeightTags::kTagged)
    accuracy.vertical_m = std::sqrt(covariance(6, 6) + common_v * common_v + 0.25 * vertical_span_m * vertical_span_m);
  return accuracy;
}

survey::GravityEvidence Shown(const std::string& kind, int n, const Vector3d& up_in_enu, double sigma_rad, double weight) {
  const double sigma_deg = kDegrees * sigma_rad;
  constexpr double kNothing_deg = 60.0;
  survey::GravityEvidence shown{.kind = kind, .n = n, .lean_east_deg = kNan, .lean_north_deg = kNan, .sigma_deg = kNan, .weight = weight};
  if (!(sigma_deg < kNothing_deg)) return shown;
  shown.lean_east_deg = kDegrees * std::atan2(up_in_enu.x(), up_in_enu.z());
  shown.lean_north_deg = kDegrees * std::atan2(up_in_enu.y(), up_in_enu.z());
  shown.sigma_deg = sigma_deg;
  return shown;
}

// Evidence with its share of the information on the final tilt. `tilt` is the final covariance of up in the tangent plane of the model's up.
std::vector<survey::GravityEvidence> ShownEvidence(const Gravity& gravity, const Eigen::Quaterniond& enu_from_model, double tags_share) {
  std::vector<survey::GravityEvidence> shown;
  double total = 0.0;
  for (const UpEvidence& evidence : gravity.evidence) total += evidence.used ? evidence.information.trace() : 0.0;
  for (const UpEvidence& evidence : gravity.evidence) {
    const double share = evidence.used && total > 0.0 ? (1.0 - tags_share) * evidence.information.trace() / total : 0.0;
    shown.push_back(Shown(evidence.kind, evidence.n, enu_from_model * evidence.up, evidence.Sigma(), share));
  }
  return shown;
}

void ReportBias(const Survey& survey, const std::vector<Tag>& tags, const Adjustment& adjustment, survey::GeoFit& fit) {
  const auto n_flights = static_cast<size_t>(CountFlights(survey.flight));
  std::vector<double> first(n_flights, kNan), last(n_flights, kNan), sum(n_flights, 0.0), count(n_flights, 0.0);
  for (size_t k = 0; k < tags.size(); ++k) {
    const auto f = static_cast<size_t>(survey.flight[tags[k].station]);
    if (std::isnan(first[f])) first[f] = adjustment.bias_m[k];
    last[f] = adjustment.bias_m[k];
    sum[f] += adjustment.bias_m[k];
    count[f] += 1.0;
  }
  for (size_t f = 0; f < n_flights; ++f) {
    const double offset_m = count[f] > 0.0 ? -sum[f] / count[f] : 0.0;
    constexpr double kRounding_m = 1e-9;  // of the reference flight, whose drift has mean zero
    fit.flight_vertical_offset_m.push_back(std::abs(offset_m) > kRounding_m ? offset_m : 0.0);
    fit.flight_vertical_drift_m.push_back(count[f] > 0.0 ? last[f] - first[f] : 0.0);
  }
}

// All stages for tags that may fit. Sets result.ok.
void FitTags(const Survey& survey, const Gravity& gravity, HeightTags heights, Georeference& result) {
  const std::vector<Tag> tags = CollectTags(survey.stations, survey.track.order(), result.origin, heights);
  const TagsAlone alone = FitTagsAlone(survey.stations, tags, survey.options);
  Vector3d up = gravity.up;
  const double gravity_sigma_deg = kDegrees * gravity.Sigma();
  // Cameras that were turned at random say nothing about gravity; then the positions have to.
  if (!(gravity_sigma_deg < kMaxUsefulSigma_deg) && alone.ok) up = alone.up_in_model;
  const Eigen::Quaterniond level_from_model = Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ()).normalized();
  const HorizontalFit flat = FitLevelled(survey, tags, level_from_model.toRotationMatrix());
  if (!flat.ok) {
    result.problems.push_back(NoPlace("no_fit", "the GPS tags do not determine position, scale and direction", "Use photos with good GPS tags"));
    return;
  }
  geo::Similarity3d start = Raised(survey, tags, level_from_model, flat);
  Vector3d middle = Vector3d::Zero();
  for (const Station& station : survey.stations) middle += station.cam_from_model.OriginInSource() / static_cast<double>(survey.stations.size());

  HeightBias bias;
  if (survey.options.flight_offsets != "off" && heights != HeightTags::kUnknown) {
    std::vector<int> flight;
    std::vector<double> phase;
    for (const Tag& tag : tags) {
      flight.push_back(survey.flight[tag.station]);
      phase.push_back(survey.track.Phase(tag.station));
    }
    bias = HeightBias(flight, phase, ReferenceFlight(survey.stations, tags, survey.flight));
  }
  const BiasChoice choice = ChooseBias(Heights(survey, tags, start, flat, gravity, middle), bias);
  start = Turned(start, start * middle, choice.solution);
  const auto n_rtk = std::count_if(tags.begin(), tags.end(), [&](const Tag& tag) { return survey.stations[tag.station].rtk; });
  const bool lags = LagsToTry(survey).size() > 1;
  const double lag_sigma_s = !lags ? 0.0 : 2 * n_rtk > static_cast<std::ptrdiff_t>(tags.size()) ? kRtkLagSigma_s : kLagSigma_s;
  const Adjustment adjustment = Adjust({.track = survey.track,
                                        .gravity = gravity,
                                        .tags = tags,
                                        .bias = bias,
                                        .bias_sigmas = choice.sigmas,
                                        .middle_in_model = middle,
                                        .threshold_m = survey.options.ransac_threshold_m,
                                        .lag_sigma_s = lag_sigma_s},
                                       {start, flat.lag_s, choice.solution.tail(bias.size())});
  result.enu_from_model = adjustment.enu_from_model;
  survey::GeoFit& fit = result.fit;
  double low = 0.0, high = 0.0;
  for (size_t k = 0; k < tags.size(); ++k) {
    const size_t i = tags[k].station;
    const Vector3d moved =
        adjustment.enu_from_model.scale * (adjustment.enu_from_model.rotation *
                                           (survey.stations[i].cam_from_model.OriginInSource() - survey.track.Before(i, adjustment.lag_s).position));
    result.correction_m[i] = moved - adjustment.bias_m[k] * Vector3d::UnitZ();
    low = std::min(low, adjustment.bias_m[k]);
    high = std::max(high, adjustment.bias_m[k]);
  }
  Evaluate(survey.stations, tags, survey.options.ransac_threshold_m, result);
  fit.tag_lag_s = adjustment.lag_s;
  fit.tag_lag_sigma_s = lags ? std::sqrt(adjustment.covariance(7, 7)) : kNan;
  if (bias.size() > 0) ReportBias(survey, tags, adjustment, fit);
  fit.accuracy = AccuracyOf(adjustment, tags, heights, high - low);
  const double tags_share = std::clamp(0.5 * (adjustment.covariance.topLeftCorner<2, 2>() * adjustment.tags_information).trace(), 0.0, 1.0);
  fit.gravity = ShownEvidence(gravity, adjustment.enu_from_model.rotation, tags_share);
  if (heights != HeightTags::kUnknown && adjustment.tags_covariance.allFinite()) {
    const Vector2d turn = adjustment.tags_rotation;
    fit.gravity.push_back(Shown("gps_heights", fit.n_inliers, Vector3d(-turn.y(), turn.x(), 1.0).normalized(),
                                std::sqrt(adjustment.tags_covariance.trace()), tags_share));
  }
  if (alone.ok) {
    const Vector3d tags_up = adjustment.enu_from_model.rotation * alone.up_in_model;
    fit.tags_alone_tilt_deg = kDegrees * std::atan2(tags_up.head<2>().norm(), tags_up.z());
  }
  const double noise_m = adjustment.horizontal_noise * MedianSigma(tags, &Tag::horizontal_sigma_m);
  const SecondGroup second = FindSecondGroup(tags, result, noise_m);
  // Two standard deviations reach the mean of both groups.
  const double doubt = static_cast<double>(second.n) / std::max(1.0, static_cast<double>(second.n + fit.n_inliers));
  fit.accuracy.horizontal_m = std::hypot(fit.accuracy.horizontal_m, 0.5 * doubt * second.distance_m);
  const bool one_line = LineRatio(survey.stations, level_from_model.toRotationMatrix()) < kLineRatio;
  for (survey::Problem& problem : TooUncertain(fit, one_line)) result.problems.push_back(std::move(problem));
  if (!result.problems.empty()) return;
  result.ok = true;
  PlaceFindings findings{.fit = fit,
                         .gimbal_used = !gravity.evidence.empty() && gravity.evidence.front().kind == "gimbal",
                         .one_line = one_line,
                         .heights = heights,
                         .tags_alone_sigma_deg = alone.ok ? alone.sigma_deg : 0.0,
                         .gravity_sigma_deg = gravity_sigma_deg,
                         .vertical_span_m = high - low,
                         .second_group = second.n,
                         .second_group_m = second.distance_m};
  for (const Tag& tag : tags) {
    if (result.inlier[tag.station] == 0) findings.disagreeing.push_back(survey.stations[tag.station].name);
  }
  std::sort(findings.disagreeing.begin(), findings.disagreeing.end());
  result.problems = PlaceProblems(findings);
}

// When most tags disagree: are their coordinates written wrongly in one of the usual ways? A mirrored line is a line, so photos on one line cannot
// tell.
std::optional<survey::Problem> CoordinateProblem(const Survey& survey, const Gravity& gravity, int n_tags) {
  const Matrix3d level_from_model = Eigen::Quaterniond::FromTwoVectors(gravity.up, Vector3d::UnitZ()).toRotationMatrix();
  if (LineRatio(survey.stations, level_from_model) < kLineRatio) return std::nullopt;
  const auto agreeing = [&](const std::vector<Station>& stations) {
    const std::vector<Tag> tags = CollectTags(stations, survey.track.order(), MedianPosition(stations), HeightTags::kUnknown);
    return FitLevelled({stations, survey.track, survey.flight, survey.options}, tags, level_from_model).n_inliers;
  };
  const int as_given = agreeing(survey.stations);
  std::optional<survey::Problem> found;
  int most = 0;
  for (const CoordinateFault& fault : PossibleCoordinateFaults(survey.stations)) {
    const int repaired = agreeing(fault.repaired);
    if (repaired <= most || repaired < kMinAgreeing || 2 * repaired <= n_tags || 2 * repaired <= 3 * as_given) continue;
    most = repaired;
    found = fault.problem;
  }
  return found;
}

}  // namespace

Georeference PlaceOnEarth(const std::vector<Station>& stations, const std::vector<Vector3d>& points, const PrepareOptions& options) {
  Georeference result;
  result.flight = SplitFlights(stations, options.flight_gap_s);
  Clear(stations.size(), result);
  const Gravity gravity = FindGravity(stations, points);
  const auto n_tagged = std::count_if(stations.begin(), stations.end(), [](const Station& station) { return station.gps.has_value(); });
  result.fit.n_matches = static_cast<int>(n_tagged);
  const char* use_tags =
      "Use photos with GPS tags (EXIF or XMP): at least four that agree, not all in one place. Then run the same command with --restart";
  if (n_tagged == 0) {
    result.problems.push_back(NoPlace("no_gps", "no photo with a pose has a GPS tag", use_tags));
  } else if (n_tagged < kMinAgreeing) {
    result.problems.push_back(
        NoPlace("too_few_tags", "only " + std::to_string(n_tagged) + " photos with a pose have a GPS tag, 4 are needed", use_tags));
  } else if (AllTagsEqual(stations)) {
    result.problems.push_back(NoPlace("equal_tags", "all GPS tags are at one place",
                                      "The tags were copied from one photo, or the receiver had no fix. Tag the photos from the flight log, then run "
                                      "the same command with --restart"));
  } else {
    result.origin = MedianPosition(stations);
    const Track track(stations, result.flight);
    const Survey survey{stations, track, result.flight, options};
    FitTags(survey, gravity, JudgeHeights(stations), result);
    if (2 * result.fit.n_inliers < result.fit.n_matches) {
      if (const auto fault = CoordinateProblem(survey, gravity, result.fit.n_matches)) {
        result.ok = false;
        result.problems = {NoPlace(fault->code, fault->finding, fault->advice)};
      }
    }
  }
  if (!result.ok) {
    result.reason = result.problems.front().finding;
    result.origin = {};
    Clear(stations.size(), result);
    result.enu_from_model = LocalFrame(stations, points, gravity.up);
    // Residuals, corrections and accuracies of a fit that was refused say nothing about the local frame.
    const survey::GeoFit refused = result.fit;
    result.fit = {.n_matches = refused.n_matches,
                  .n_inliers = refused.n_inliers,
                  .rmse_m = kNan,
                  .rmse_horizontal_m = kNan,
                  .rmse_vertical_m = kNan,
                  .scale = result.enu_from_model.scale};
    result.fit.gravity = ShownEvidence(gravity, result.enu_from_model.rotation, 0.0);
  }
  return result;
}

Georeference KeepExactFrame(const std::vector<Station>& stations, const geo::Geodetic& origin, const PrepareOptions& options) {
  Georeference result;
  result.ok = true;
  result.origin = origin;
  result.flight = SplitFlights(stations, options.flight_gap_s);
  Clear(stations.size(), result);
  const Track track(stations, result.flight);
  Evaluate(stations, CollectTags(stations, track.order(), origin, HeightTags::kTagged), options.ransac_threshold_m, result);
  result.fit.accuracy = {.scale_percent = 0.0, .tilt_deg = 0.0, .yaw_deg = 0.0, .horizontal_m = 0.0, .vertical_m = 0.0};
  PlaceFindings findings{.fit = result.fit, .gimbal_used = true};
  for (size_t i = 0; i < stations.size(); ++i) {
    if (stations[i].gps && result.inlier[i] == 0) findings.disagreeing.push_back(stations[i].name);
  }
  result.problems = PlaceProblems(findings);
  return result;
}

}  // namespace skyquilt::prepare
