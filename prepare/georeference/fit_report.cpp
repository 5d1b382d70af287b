#include "prepare/georeference/fit_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace skyquilt::prepare::georeference {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
// A receiver's error that all its tags share is invisible in residuals. Shares of the stated or typical accuracy: 1.5 m and 3 m without RTK.
constexpr double kCommonHorizontal = 0.5;
constexpr double kCommonVertical = 2.0 / 3.0;
constexpr double kLeastGroupRadius_m = 2.0, kGroupSigmas = 3.0, kGroupShare = 0.2;

survey::GravityEvidence Shown(const std::string& kind, int n, const Vector3d& up_in_enu, double sigma_rad, double weight) {
  const double sigma_deg = kDegreesPerRadian * sigma_rad;
  constexpr double kNothing_deg = 60.0;
  survey::GravityEvidence shown{.kind = kind, .n = n, .lean_east_deg = kUnknown, .lean_north_deg = kUnknown, .sigma_deg = kUnknown, .weight = weight};
  if (!(sigma_deg < kNothing_deg)) return shown;
  shown.lean_east_deg = kDegreesPerRadian * std::atan2(up_in_enu.x(), up_in_enu.z());
  shown.lean_north_deg = kDegreesPerRadian * std::atan2(up_in_enu.y(), up_in_enu.z());
  shown.sigma_deg = sigma_deg;
  return shown;
}

}  // namespace

geo::PlaceAccuracy AccuracyOf(const Adjustment& adjustment, const std::vector<Tag>& tags, HeightTags heights, double vertical_span_m) {
  const auto& covariance = adjustment.covariance;
  const double common_h = kCommonHorizontal * MedianSigma(tags, &Tag::horizontal_sigma_m);
  const double common_v = kCommonVertical * MedianSigma(tags, &Tag::vertical_sigma_m);
  geo::PlaceAccuracy accuracy;
  accuracy.scale_percent = 100.0 * std::sqrt(covariance(3, 3));
  accuracy.tilt_deg = kDegreesPerRadian * std::sqrt(covariance(0, 0) + covariance(1, 1));
  accuracy.yaw_deg = kDegreesPerRadian * std::sqrt(covariance(2, 2));
  accuracy.horizontal_m = std::sqrt(covariance(4, 4) + covariance(5, 5) + 2.0 * common_h * common_h);
  // Which moment of a drift has the right height is unknown.
  if (heights == HeightTags::kTagged)
    accuracy.vertical_m = std::sqrt(covariance(6, 6) + common_v * common_v + 0.25 * vertical_span_m * vertical_span_m);
  return accuracy;
}

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

survey::GravityEvidence HeightEvidence(const Adjustment& adjustment, int n, double tags_share) {
  const Vector2d turn = adjustment.tags_rotation;
  return Shown("gps_heights", n, Vector3d(-turn.y(), turn.x(), 1.0).normalized(), std::sqrt(adjustment.tags_covariance.trace()), tags_share);
}

void ReportBias(const std::vector<int>& flight, const std::vector<Tag>& tags, const Adjustment& adjustment, survey::GeoFit& fit) {
  const auto n_flights = static_cast<size_t>(input::CountFlights(flight));
  std::vector<double> first(n_flights, kUnknown), last(n_flights, kUnknown), sum(n_flights, 0.0), count(n_flights, 0.0);
  for (size_t k = 0; k < tags.size(); ++k) {
    const auto f = static_cast<size_t>(flight[tags[k].photo]);
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

SecondGroup FindSecondGroup(const std::vector<Tag>& tags, const Georeference& result, double noise_m) {
  std::vector<Vector2d> others;
  for (const Tag& tag : tags) {
    const TagFit& fit = result.photos[tag.photo];
    if (!fit.inlier) others.emplace_back(fit.residual_m.head<2>());
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

}  // namespace skyquilt::prepare::georeference
