#include "prepare/georeference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/geo/robust_similarity.h"

namespace skyquilt::prepare {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kMaxOffsetRounds = 20;

// Medians are taken in an ENU frame, which has no special case at the poles and the date line. The frame starts at one of the tags and is moved to
// the median, where it is level.
geo::Geodetic MedianPosition(const std::vector<Station>& stations) {
  std::vector<double> heights;
  std::optional<geo::Geodetic> centre;
  for (const Station& station : stations) {
    if (!station.gps) continue;
    heights.push_back(station.gps->height_m);
    if (!centre) centre = station.gps;
  }
  for (int round = 0; round < 3; ++round) {
    const geo::EnuFrame frame(*centre);
    std::vector<double> axis[3];
    for (const Station& station : stations) {
      if (!station.gps) continue;
      const Eigen::Vector3d x = frame.EnuFromGeodetic(*station.gps);
      for (int i = 0; i < 3; ++i) axis[i].push_back(x[i]);
    }
    centre = frame.GeodeticFromEnu({base::Median(axis[0]), base::Median(axis[1]), base::Median(axis[2])});
  }
  return {centre->latitude_deg, centre->longitude_deg, base::Median(heights)};
}

// Pairs to fit: camera centres in the model and tagged positions in ENU.
struct Matches {
  std::vector<size_t> station;
  std::vector<Eigen::Vector3d> in_model;
  std::vector<Eigen::Vector3d> in_enu;  // as tagged
};

Matches CollectMatches(const std::vector<Station>& stations, const geo::Geodetic& origin) {
  const geo::EnuFrame frame(origin);
  Matches matches;
  for (size_t i = 0; i < stations.size(); ++i) {
    if (!stations[i].gps) continue;
    matches.station.push_back(i);
    matches.in_model.push_back(stations[i].cam_from_model.OriginInSource());
    matches.in_enu.push_back(frame.EnuFromGeodetic(*stations[i].gps));
  }
  return matches;
}

std::vector<Eigen::Vector3d> WithOffsets(const Matches& matches, const std::vector<int>& flight, const std::vector<double>& offset_m) {
  std::vector<Eigen::Vector3d> shifted = matches.in_enu;
  if (offset_m.empty()) return shifted;
  for (size_t m = 0; m < shifted.size(); ++m) shifted[m].z() += offset_m[static_cast<size_t>(flight[matches.station[m]])];
  return shifted;
}

// Per flight: median of fitted minus tagged height over the tags that fit horizontally. NaN for a flight without any.
std::vector<double> FlightHeightDifference(const Matches& matches, const geo::Similarity3d& enu_from_model, const std::vector<int>& flight,
                                           int n_flights, double threshold_m) {
  std::vector<std::vector<double>> differences(static_cast<size_t>(n_flights));
  for (size_t m = 0; m < matches.station.size(); ++m) {
    const Eigen::Vector3d residual = enu_from_model * matches.in_model[m] - matches.in_enu[m];
    if (residual.head<2>().norm() <= threshold_m) differences[static_cast<size_t>(flight[matches.station[m]])].push_back(residual.z());
  }
  std::vector<double> median;
  for (const std::vector<double>& values : differences) median.push_back(base::Median(values));
  return median;
}

int ReferenceFlight(const std::vector<Station>& stations, const std::vector<int>& flight, int n_flights) {
  std::vector<int> n_tagged(static_cast<size_t>(n_flights), 0);
  std::vector<int> n_rtk(static_cast<size_t>(n_flights), 0);
  for (size_t i = 0; i < stations.size(); ++i) {
    if (!stations[i].gps) continue;
    ++n_tagged[static_cast<size_t>(flight[i])];
    n_rtk[static_cast<size_t>(flight[i])] += stations[i].rtk ? 1 : 0;
  }
  const std::vector<int>& votes = *std::max_element(n_rtk.begin(), n_rtk.end()) > 0 ? n_rtk : n_tagged;
  return static_cast<int>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

// Fills in residuals, inliers and the errors of the fit, from the transform and the offsets in `result`.
void Evaluate(const std::vector<Station>& stations, const Matches& matches, double threshold_m, Georeference& result) {
  result.residual_m.assign(stations.size(), kNan);
  result.residual_up_m.assign(stations.size(), kNan);
  result.inlier.assign(stations.size(), 0);
  const std::vector<Eigen::Vector3d> tags = WithOffsets(matches, result.flight, result.fit.flight_vertical_offset_m);
  double horizontal = 0.0;
  double vertical = 0.0;
  survey::GeoFit& fit = result.fit;
  fit.n_matches = static_cast<int>(matches.station.size());
  fit.n_inliers = 0;
  for (size_t m = 0; m < matches.station.size(); ++m) {
    const Eigen::Vector3d residual = result.enu_from_model * matches.in_model[m] - tags[m];
    const size_t i = matches.station[m];
    result.residual_m[i] = residual.norm();
    result.residual_up_m[i] = residual.z();
    if (residual.norm() > threshold_m) continue;
    result.inlier[i] = 1;
    ++fit.n_inliers;
    horizontal += residual.head<2>().squaredNorm();
    vertical += residual.z() * residual.z();
  }
  const double n = fit.n_inliers > 0 ? static_cast<double>(fit.n_inliers) : kNan;
  fit.rmse_horizontal_m = std::sqrt(horizontal / n);
  fit.rmse_vertical_m = std::sqrt(vertical / n);
  fit.rmse_m = std::sqrt((horizontal + vertical) / n);
  fit.scale = result.enu_from_model.scale;
}

int CountFlights(const std::vector<int>& flight) {
  return flight.empty() ? 0 : *std::max_element(flight.begin(), flight.end()) + 1;
}

// Estimates one vertical offset per flight, in turn with the transform, until both converge. Changes nothing when the flights agree.
void FitFlightOffsets(const std::vector<Station>& stations, const Matches& matches, const PrepareOptions& options,
                      const geo::RobustSimilarityOptions& robust, Georeference& result) {
  const int n_flights = CountFlights(result.flight);
  if (n_flights < 2 || options.flight_offsets == "off") return;
  std::vector<double> offset_m(static_cast<size_t>(n_flights), 0.0);
  geo::Similarity3d transform = result.enu_from_model;
  const auto reference = static_cast<size_t>(ReferenceFlight(stations, result.flight, n_flights));
  for (int round = 0; round < kMaxOffsetRounds; ++round) {
    const std::vector<double> difference = FlightHeightDifference(matches, transform, result.flight, n_flights, options.ransac_threshold_m);
    if (round == 0) {
      std::vector<double> known;
      std::copy_if(difference.begin(), difference.end(), std::back_inserter(known), [](double value) { return std::isfinite(value); });
      if (known.size() < 2 || !std::isfinite(difference[reference])) return;
      if (*std::max_element(known.begin(), known.end()) - *std::min_element(known.begin(), known.end()) <= kFlightOffsetTrigger_m) return;
    }
    if (!std::isfinite(difference[reference])) return;
    double change_m = 0.0;
    for (size_t f = 0; f < offset_m.size(); ++f) {
      const double wanted = std::isfinite(difference[f]) ? difference[f] - difference[reference] : offset_m[f];
      change_m = std::max(change_m, std::abs(wanted - offset_m[f]));
      offset_m[f] = wanted;
    }
    if (round > 0 && change_m < 0.01) break;
    const geo::RobustSimilarityFit refit = geo::FitSimilarityRobustly(matches.in_model, WithOffsets(matches, result.flight, offset_m), robust);
    if (!refit.ok) return;
    transform = refit.b_from_a;
  }
  result.enu_from_model = transform;
  result.fit.flight_vertical_offset_m = offset_m;
}

}  // namespace

std::vector<int> SplitFlights(const std::vector<Station>& stations, double gap_s) {
  std::vector<size_t> timed;
  for (size_t i = 0; i < stations.size(); ++i) {
    if (stations[i].time_s) timed.push_back(i);
  }
  std::stable_sort(timed.begin(), timed.end(), [&](size_t a, size_t b) { return *stations[a].time_s < *stations[b].time_s; });
  std::vector<int> flight(stations.size(), -1);
  int current = 0;
  for (size_t k = 0; k < timed.size(); ++k) {
    if (k > 0 && *stations[timed[k]].time_s - *stations[timed[k - 1]].time_s > gap_s) ++current;
    flight[timed[k]] = current;
  }
  int before = 0;
  for (int& number : flight) {
    if (number < 0) number = before;
    before = number;
  }
  return flight;
}

Georeference FitToGps(const std::vector<Station>& stations, const PrepareOptions& options) {
  Georeference result;
  result.flight = SplitFlights(stations, options.flight_gap_s);
  result.residual_m.assign(stations.size(), kNan);
  result.residual_up_m.assign(stations.size(), kNan);
  result.inlier.assign(stations.size(), 0);
  const auto n_tagged = std::count_if(stations.begin(), stations.end(), [](const Station& station) { return station.gps.has_value(); });
  result.fit.n_matches = static_cast<int>(n_tagged);
  if (n_tagged < 3) {
    result.reason = n_tagged == 0 ? "no photo with a pose has a GPS tag"
                                  : "only " + std::to_string(n_tagged) + " photo(s) with a pose have a GPS tag, 3 are needed";
    return result;
  }
  result.origin = MedianPosition(stations);
  const Matches matches = CollectMatches(stations, result.origin);
  const geo::RobustSimilarityOptions robust{
      .inlier_threshold_m = options.ransac_threshold_m, .iterations = 2000, .seed = static_cast<uint64_t>(options.seed)};
  const geo::RobustSimilarityFit first = geo::FitSimilarityRobustly(matches.in_model, matches.in_enu, robust);
  if (!first.ok) {
    result.reason = std::string("GPS tags do not determine position, scale and rotation: ") + first.reason;
    return result;
  }
  result.ok = true;
  result.enu_from_model = first.b_from_a;
  FitFlightOffsets(stations, matches, options, robust, result);
  Evaluate(stations, matches, options.ransac_threshold_m, result);
  return result;
}

Georeference KeepExactFrame(const std::vector<Station>& stations, const geo::Geodetic& origin, const PrepareOptions& options) {
  Georeference result;
  result.ok = true;
  result.origin = origin;
  result.flight = SplitFlights(stations, options.flight_gap_s);
  Evaluate(stations, CollectMatches(stations, origin), options.ransac_threshold_m, result);
  return result;
}

}  // namespace skyquilt::prepare
