#include "prepare/georeference/georeference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/geo/robust_similarity.h"
#include "core/linear/linear.h"
#include "prepare/georeference/fit_report.h"
#include "prepare/georeference/height_bias.h"
#include "prepare/georeference/levelled_fit.h"
#include "prepare/georeference/place_adjustment.h"
#include "prepare/georeference/place_problems.h"
#include "prepare/georeference/tags/photo_column.h"
#include "prepare/georeference/tags/tags.h"
#include "prepare/georeference/tags/track.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180.0 / std::numbers::pi;
// Receivers lag by up to a few seconds; RTK drones record the time of exposure.
constexpr double kLagSigma_s = 1.5;
constexpr double kRtkLagSigma_s = 0.05;
constexpr double kMaxUsefulSigma_deg = 5.0;

// Of photos without tags.
std::vector<TagFit> NoFits(const std::vector<int>& flight) {
  std::vector<TagFit> fits;
  for (const int number : flight) fits.push_back({.flight = number});
  return fits;
}

// Residuals and the errors of the fit, from the transform and the corrections in `result`.
void Evaluate(const std::vector<input::PreparedPhoto>& photos, const std::vector<Tag>& tags, double threshold_m, Georeference& result) {
  survey::GeoFit& fit = result.fit;
  fit.n_matches = static_cast<int>(tags.size());
  fit.n_inliers = 0;
  fit.scale = result.enu_from_model.scale;
  double horizontal = 0.0, vertical = 0.0;
  int n_heights = 0;
  for (const Tag& tag : tags) {
    TagFit& of_photo = result.photos[tag.photo];
    const Vector3d centre = result.enu_from_model * photos[tag.photo].cam_from_model.OriginInSource();
    const Vector3d residual = centre - (tag.x_in_enu + of_photo.correction_m);
    of_photo.residual_m = residual;
    const bool has_height = std::isfinite(residual.z());
    const bool agrees = residual.head<2>().norm() <= threshold_m && (!has_height || std::abs(residual.z()) <= threshold_m);
    of_photo.inlier = agrees;
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
int ReferenceFlight(const std::vector<input::PreparedPhoto>& photos, const std::vector<Tag>& tags, const std::vector<int>& flight) {
  std::vector<int> n_tagged(static_cast<size_t>(input::CountFlights(flight)), 0), n_rtk = n_tagged;
  for (const Tag& tag : tags) {
    ++n_tagged[static_cast<size_t>(flight[tag.photo])];
    n_rtk[static_cast<size_t>(flight[tag.photo])] += photos[tag.photo].rtk ? 1 : 0;
  }
  const std::vector<int>& votes = *std::max_element(n_rtk.begin(), n_rtk.end()) > 0 ? n_rtk : n_tagged;
  return static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

// The fit to positions alone, for comparison.
struct TagsAlone {
  bool ok = false;
  Vector3d up_in_model = Vector3d::UnitZ();
  double sigma_deg = kNan;
  geo::Similarity3d enu_from_model;
};

TagsAlone FitTagsAlone(const std::vector<input::PreparedPhoto>& photos, const std::vector<Tag>& tags, const PlaceOptions& options) {
  std::vector<Vector3d> in_model, in_enu;
  for (const Tag& tag : tags) {
    if (!tag.x_in_enu.allFinite()) continue;
    in_model.push_back(photos[tag.photo].cam_from_model.OriginInSource());
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
  const Vector3d squares = linear::SymmetricEigen<3>(centred * centred.transpose()).values;
  // The second largest singular value of the positions.
  alone.sigma_deg = kDegrees * fit.rmse_m / std::max(std::sqrt(std::max(squares[1], 0.0)), 1e-9);
  return alone;
}

// For comparison with gimbal angles that the photos contradict.
std::optional<Vector3d> UpByTags(const std::vector<input::PreparedPhoto>& photos, const PlaceOptions& options) {
  constexpr double kUseful_deg = 10.0;
  const auto n_tagged = std::count_if(photos.begin(), photos.end(), [](const input::PreparedPhoto& photo) { return photo.gps.has_value(); });
  if (n_tagged < kMinAgreeing || TagsAboveOneAnother(photos)) return std::nullopt;
  std::vector<size_t> order(photos.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const std::vector<Tag> tags = CollectTags(photos, order, MedianPosition(photos), JudgeHeights(photos));
  const TagsAlone alone = FitTagsAlone(photos, tags, options);
  return alone.ok && alone.sigma_deg < kUseful_deg ? std::optional(alone.up_in_model) : std::nullopt;
}

std::vector<input::PreparedPhoto> WithoutAngles(std::vector<input::PreparedPhoto> photos) {
  for (input::PreparedPhoto& photo : photos) photo.up_in_cam.reset();
  return photos;
}

// All stages for tags that may fit. Sets result.ok.
void FitTags(const TaggedFlight& flight, const Gravity& gravity, HeightTags heights, Georeference& result) {
  const std::vector<Tag> tags = CollectTags(flight.photos, flight.track.order(), result.origin, heights);
  const TagsAlone alone = FitTagsAlone(flight.photos, tags, flight.options);
  Vector3d up = gravity.up;
  const double gravity_sigma_deg = kDegrees * gravity.Sigma();
  // Cameras that were turned at random say nothing about gravity; then the positions have to.
  if (!(gravity_sigma_deg < kMaxUsefulSigma_deg) && alone.ok) up = alone.up_in_model;
  const Eigen::Quaterniond level_from_model = linear::RotationBetween(up, Vector3d::UnitZ()).normalized();
  const HorizontalFit flat = FitLevelled(flight, tags, level_from_model.toRotationMatrix());
  if (!flat.ok) {
    result.problems.push_back(NoPlace("no_fit", "the GPS tags do not determine position, scale and direction", "Use photos with good GPS tags"));
    return;
  }
  geo::Similarity3d start = SimilarityOfFit(flight, tags, level_from_model, flat);
  Vector3d middle = Vector3d::Zero();
  for (const input::PreparedPhoto& photo : flight.photos) middle += photo.cam_from_model.OriginInSource() / static_cast<double>(flight.photos.size());

  HeightBias bias;
  if (flight.options.flight_offsets != "off" && heights != HeightTags::kUnknown) {
    std::vector<int> number;
    std::vector<double> phase;
    for (const Tag& tag : tags) {
      number.push_back(flight.flight[tag.photo]);
      phase.push_back(flight.track.Phase(tag.photo));
    }
    bias = HeightBias(number, phase, ReferenceFlight(flight.photos, tags, flight.flight));
  }
  const BiasChoice choice = ChooseBias(ObserveHeights(flight, tags, start, flat, gravity, middle), bias);
  start = Turned(start, start * middle, choice.solution);
  const auto n_rtk = std::count_if(tags.begin(), tags.end(), [&](const Tag& tag) { return flight.photos[tag.photo].rtk; });
  const bool lags = LagsToTry(flight).size() > 1;
  const double lag_sigma_s = !lags ? 0.0 : 2 * n_rtk > static_cast<std::ptrdiff_t>(tags.size()) ? kRtkLagSigma_s : kLagSigma_s;
  const Adjustment adjustment = Adjust({.track = flight.track,
                                        .gravity = gravity,
                                        .tags = tags,
                                        .bias = bias,
                                        .bias_sigmas = choice.sigmas,
                                        .middle_in_model = middle,
                                        .threshold_m = flight.options.ransac_threshold_m,
                                        .lag_sigma_s = lag_sigma_s},
                                       {start, flat.lag_s, choice.solution.tail(bias.size())});
  result.enu_from_model = adjustment.enu_from_model;
  survey::GeoFit& fit = result.fit;
  double low = 0.0, high = 0.0;
  for (size_t k = 0; k < tags.size(); ++k) {
    const size_t i = tags[k].photo;
    const Vector3d moved =
        adjustment.enu_from_model.scale *
        (adjustment.enu_from_model.rotation * (flight.photos[i].cam_from_model.OriginInSource() - flight.track.Before(i, adjustment.lag_s).position));
    result.photos[i].correction_m = moved - adjustment.bias_m[k] * Vector3d::UnitZ();
    low = std::min(low, adjustment.bias_m[k]);
    high = std::max(high, adjustment.bias_m[k]);
  }
  Evaluate(flight.photos, tags, flight.options.ransac_threshold_m, result);
  fit.tag_lag_s = adjustment.lag_s;
  fit.tag_lag_sigma_s = lags ? std::sqrt(adjustment.covariance(7, 7)) : kNan;
  if (bias.size() > 0) ReportBias(flight.flight, tags, adjustment, fit);
  fit.accuracy = AccuracyOf(adjustment, tags, heights, high - low);
  const double tags_share = std::clamp(0.5 * (adjustment.covariance.topLeftCorner<2, 2>() * adjustment.tags_information).trace(), 0.0, 1.0);
  fit.gravity = ShownEvidence(gravity, adjustment.enu_from_model.rotation, tags_share);
  if (heights != HeightTags::kUnknown && adjustment.tags_covariance.allFinite()) {
    fit.gravity.push_back(HeightEvidence(adjustment, fit.n_inliers, tags_share));
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
  const bool one_line = OnOneLine(flight.photos, level_from_model.toRotationMatrix());
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
    if (!result.photos[tag.photo].inlier) findings.disagreeing.push_back(flight.photos[tag.photo].file.name);
  }
  std::sort(findings.disagreeing.begin(), findings.disagreeing.end());
  result.problems = PlaceProblems(findings);
}

// When most tags disagree: are their coordinates written wrongly in one of the usual ways? A mirrored line is a line, so photos on one line cannot
// tell.
std::optional<survey::Problem> CoordinateProblem(const TaggedFlight& flight, const Gravity& gravity, int n_tags) {
  const Matrix3d level_from_model = linear::RotationBetween(gravity.up, Vector3d::UnitZ()).toRotationMatrix();
  if (OnOneLine(flight.photos, level_from_model)) return std::nullopt;
  const auto agreeing = [&](const std::vector<input::PreparedPhoto>& photos) {
    const std::vector<Tag> tags = CollectTags(photos, flight.track.order(), MedianPosition(photos), HeightTags::kUnknown);
    return FitLevelled({photos, flight.track, flight.flight, flight.options}, tags, level_from_model).n_inliers;
  };
  const int as_given = agreeing(flight.photos);
  std::optional<survey::Problem> found;
  int most = 0;
  for (const CoordinateFault& fault : PossibleCoordinateFaults(flight.photos)) {
    const int repaired = agreeing(fault.repaired);
    if (repaired <= most || repaired < kMinAgreeing || 2 * repaired <= n_tags || 2 * repaired <= 3 * as_given) continue;
    most = repaired;
    found = fault.problem;
  }
  return found;
}

// Whether the photos are above one another, and their tags do not tell the little by which they differ horizontally from noise.
bool LeavesNorthOpen(const std::vector<input::PreparedPhoto>& photos, const Gravity& gravity, const Georeference& result) {
  constexpr double kOpen_deg = 10.0;
  if (result.ok && result.fit.accuracy.yaw_deg <= kOpen_deg) return false;
  return TagsFormColumn(photos) && CamerasAboveOneAnother(photos, gravity.up);
}

}  // namespace

Georeference PlaceOnEarth(const std::vector<input::PreparedPhoto>& given, const std::vector<Vector3d>& points, const PlaceOptions& options) {
  Georeference result;
  const GravityHints hints{.tags_up =
                               [&, known = std::optional<std::optional<Vector3d>>()]() mutable {
                                 if (!known) known = UpByTags(given, options);
                                 return *known;
                               },
                           .stated_up = options.up};
  if (!hints.stated_up) result.gimbal = JudgeGimbal(given, points, hints.tags_up);
  const std::vector<input::PreparedPhoto> without_angles =
      result.gimbal.use == GimbalUse::kDropped ? WithoutAngles(given) : std::vector<input::PreparedPhoto>();
  const std::vector<input::PreparedPhoto>& photos = result.gimbal.use == GimbalUse::kDropped ? without_angles : given;
  const std::vector<int> flight_of_photo = input::SplitFlights(photos, options.flight_gap_s);
  result.photos = NoFits(flight_of_photo);
  const Gravity gravity = FindGravity(photos, points, hints);
  const auto n_tagged = std::count_if(photos.begin(), photos.end(), [](const input::PreparedPhoto& photo) { return photo.gps.has_value(); });
  result.fit.n_matches = static_cast<int>(n_tagged);
  const char* use_tags =
      "Use photos with GPS tags (EXIF or XMP): at least four that agree, not all in one place. Then run the same command with --restart";
  if (n_tagged == 0) {
    result.problems.push_back(NoPlace("no_gps", "no photo with a pose has a GPS tag", use_tags));
  } else if (n_tagged < kMinAgreeing) {
    result.problems.push_back(
        NoPlace("too_few_tags", "only " + std::to_string(n_tagged) + " photos with a pose have a GPS tag, 4 are needed", use_tags));
  } else if (TagsAboveOneAnother(photos)) {
    result.problems.push_back(OnePlaceProblem(photos, gravity.up));
  } else {
    result.origin = MedianPosition(photos);
    const Track track(photos, flight_of_photo);
    const TaggedFlight flight{photos, track, flight_of_photo, options};
    FitTags(flight, gravity, JudgeHeights(photos), result);
    if (2 * result.fit.n_inliers < result.fit.n_matches) {
      if (const auto fault = CoordinateProblem(flight, gravity, result.fit.n_matches)) {
        result.ok = false;
        result.problems = {NoPlace(fault->code, fault->finding, fault->advice)};
      }
    }
    if (LeavesNorthOpen(photos, gravity, result)) {
      result.ok = false;
      result.problems = {ColumnProblem()};
    }
  }
  if (!result.ok) {
    result.origin = {};
    result.photos = NoFits(flight_of_photo);
    result.enu_from_model = LocalFrame(photos, points, gravity.up);
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

Georeference KeepExactFrame(const std::vector<input::PreparedPhoto>& photos, const geo::Geodetic& origin, const PlaceOptions& options) {
  Georeference result;
  result.ok = true;
  result.origin = origin;
  const std::vector<int> flight_of_photo = input::SplitFlights(photos, options.flight_gap_s);
  result.photos = NoFits(flight_of_photo);
  const Track track(photos, flight_of_photo);
  Evaluate(photos, CollectTags(photos, track.order(), origin, HeightTags::kTagged), options.ransac_threshold_m, result);
  result.fit.accuracy = {.scale_percent = 0.0, .tilt_deg = 0.0, .yaw_deg = 0.0, .horizontal_m = 0.0, .vertical_m = 0.0};
  PlaceFindings findings{.fit = result.fit, .gimbal_used = true};
  for (size_t i = 0; i < photos.size(); ++i) {
    if (photos[i].gps && !result.photos[i].inlier) findings.disagreeing.push_back(photos[i].file.name);
  }
  result.problems = PlaceProblems(findings);
  return result;
}

}  // namespace skyquilt::prepare::georeference
